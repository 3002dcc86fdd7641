// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stop_token>

#include "ltm/core/progress.h"
#include "ltm/forgetting/erasure.h"

namespace engram::training {

/// An ltm::CodeAnew: codes anew the latents that share a block with what is erased, and replaces
/// models that learned from it or keep its pictures by ones without.
///
/// Latents of snapshots that are still recorded are removed, and the next night makes new ones.
/// Others are decoded and coded again as video, at a quality whose error adds a quarter to the
/// error that they have. Errors: those of the store and of the models; kCancelled on a stop.
/// Threading: one job at a time for a store.
/// Source: docs/forgetting.md, section "Erasing".
Result<ltm::Erasures> code_anew(const std::filesystem::path& store, const ltm::ForgetSet& gone,
                                const ProgressSink& progress, const std::stop_token& stop);

}  // namespace engram::training
