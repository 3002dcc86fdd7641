// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stop_token>

#include "augmentation/recipe.h"
#include "ltm/core/progress.h"
#include "training/augment/augment_options.h"
#include "training/augment/augmented_store.h"

namespace engram::training {

/// The recipe of copy `copy` of the snapshots at `time`. It depends on nothing else.
/// Source: docs/augmentation.md, section "Recipes".
[[nodiscard]] augmentation::Recipe recipe_at(const AugmentOptions& options, Time time, int copy);

/// Makes a new store of changed snapshots. Each keeps its entity, time and metadata, and names its
/// recipe and the instance that it was made of. For n instances, instance i of copy k has the
/// number k n + i. Nothing is filtered. If it is stopped, the new store is valid and has the
/// snapshots made so far.
/// Errors: kAlreadyExists if `to` exists; kNotFound if no entity matches; kInvalidArgument; the
/// errors of the stores.
Result<AugmentReport> augment_store(const std::filesystem::path& from,
                                    const std::filesystem::path& to, const AugmentOptions& options,
                                    const ProgressSink& progress, const std::stop_token& stop);

}  // namespace engram::training
