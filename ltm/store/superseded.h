// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "ltm/store/rewrite.h"

namespace engram::ltm {

/// Removes from latent segments the rows of `entity` that newer latents of the same times replaced.
/// Publishing leaves them where their segment has other rows too. A kill at any moment loses
/// nothing: call it again.
/// Errors: kNotFound if the store has no such entity; kDataLoss if a segment is damaged (that
/// segment stays unchanged); kUnavailable, kResourceExhausted.
/// Threading: may run beside a live writer and beside readers.
Result<RewriteReport> remove_superseded_latents(const std::filesystem::path& store,
                                                const MemoryId& entity);

/// The same, and removes the latents of `unwanted`, whose snapshots stay in their recorded form,
/// and those of older recorded forms. Nothing of a block is left if all its rows go. Errors: as
/// above; kFailedPrecondition if a snapshot has no other form: its latents then stay.
Result<RewriteReport> remove_latents(const std::filesystem::path& store, const MemoryId& entity,
                                     const TimeSet& unwanted);

/// Removes from recorded segments the rows that newer ones replaced, from those segments that have
/// any of these snapshots. The snapshots stay in their newest form.
/// Errors: those of compact; kCancelled on a stop, between two segments.
Result<RewriteReport> remove_superseded_recorded(const std::filesystem::path& store,
                                                 const ForgetSet& replaced,
                                                 const ProgressSink& progress = {},
                                                 const std::stop_token& stop = {});

}  // namespace engram::ltm
