// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

#include "ltm/core/progress.h"
#include "ltm/memory/query.h"
#include "ltm/reflection/reflection.h"
#include "ltm/store/store_reader.h"

namespace engram::ltm {

/// The memory that reflections are kept in; it is not looked at itself.
inline constexpr const char* kReflectionMemory = "Reflection";

struct ReflectOptions {
  /// Which entities and snapshots are looked at. Empty: all, but for those of kReflectionMemory.
  std::optional<Query> query;
  /// Only the names of the query count, and all snapshots are looked at.
  bool are_names_only = true;
  /// Looks for images that stand still, too. It reads all images in their stored form, and decodes
  /// those that are stored as video.
  bool with_images = false;
};

/// Looks at what a store holds: rates, gaps, bounds, values that stand still, come again, jump or
/// drift, links that lead nowhere, clocks that differ, and what became of actions.
///
/// What is usual is learned from the entity itself, or from those of its provider segment, in
/// quantiles that a few faults do not move; no constant says how fast a camera or an arm is.
/// Augmented snapshots are left out. Of snapshots that are latents alone only their times are
/// looked at. Values are read in blocks of a bounded size, each of which is looked at for itself;
/// times are all in memory.
///
/// Errors: kNotFound if no entity matches the query; kCancelled; kUnavailable; those of Timeline.
/// Snapshots that do not decode are findings. Threading: one thread. Complexity: O(n) in the bytes
/// of the values. Source: docs/reflection.md.
Result<Reflection> reflect(StoreReader& store, const ReflectOptions& options = {},
                           const ProgressSink& progress = {}, const std::stop_token& stop = {});

/// Opens the store and reflects on it. Errors: also those of StoreReader::open.
Result<Reflection> reflect(const std::filesystem::path& store, const ReflectOptions& options = {},
                           const ProgressSink& progress = {}, const std::stop_token& stop = {});

/// Takes a query in its text form, with or without selectors; an empty one is everything.
/// Errors: kInvalidArgument.
Result<ReflectOptions> reflect_options(const std::string& query);

}  // namespace engram::ltm
