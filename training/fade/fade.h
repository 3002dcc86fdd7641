// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stop_token>

#include "ltm/core/progress.h"
#include "ltm/forgetting/fade_report.h"

namespace engram::training {

/// Lets snapshots fade: codes their images again with a lower quality, from what was recorded where
/// that is still there, else from their latents. Then what is recorded of them, and their latents
/// from before, are removed. It is an ltm::Fade.
///
/// Latents that are coded as one block fade together, so snapshots beside some that stay good stay
/// good as well (ltm::FadeReport::waiting). Blocks are published every two minutes, so a kill loses
/// no more than that work, and never a snapshot.
/// Errors: kDataLoss, kUnavailable, kResourceExhausted. A stop is no error.
/// Threading: may run beside a live writer and beside readers; not beside consolidation of the same
/// entities, whose latents of the same snapshots could be replaced.
/// Source: docs/forgetting.md, section "Memories that fade".
Result<ltm::FadeReport> fade(const std::filesystem::path& store, const ltm::FadeSet& what,
                             const ProgressSink& progress, const std::stop_token& stop);

}  // namespace engram::training
