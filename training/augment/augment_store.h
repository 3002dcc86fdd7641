// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stop_token>

#include "augmentation/recipe.h"
#include "ltm/core/progress.h"
#include "training/augment/augment_options.h"
#include "training/augment/augmented_store.h"

namespace engram::training {

/// The recipe of copy `copy` of what was seen at `time`. Depends on nothing else.
/// Source: docs/augmentation.md, section "Recipes".
[[nodiscard]] augmentation::Recipe recipe_at(const AugmentOptions& options, Time time, int copy);

/// Makes a new store of changed snapshots. Each keeps its entity, time and metadata, and names the
/// instance that it was made of and the recipe; instance i of copy k is number k n + i of n.
/// Nothing is filtered. Where it was stopped, what is there is whole.
/// Errors: kAlreadyExists where `to` is there; kNotFound where no entity matches; kInvalidArgument;
/// those of the stores.
Result<AugmentReport> augment_store(const std::filesystem::path& from,
                                    const std::filesystem::path& to, const AugmentOptions& options,
                                    const ProgressSink& progress, const std::stop_token& stop);

}  // namespace engram::training
