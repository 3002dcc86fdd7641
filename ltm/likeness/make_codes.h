// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <stop_token>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/likeness/likeness_space.h"
#include "ltm/recall/model.h"

namespace engram::ltm {

struct CodesOptions {
  /// Which entities are coded; empty: all with images.
  std::function<bool(const MemoryId&)> matches{};
  /// Asked before each image, while learning too; true ends the job. What was coded until then is
  /// kept.
  std::function<bool()> is_over{};
};

/// What was done for one entity.
struct EntityCoding {
  MemoryId entity;
  std::string space;        ///< LikenessSpace::name().
  bool is_learned = false;  ///< The space is new.
  uint64_t coded = 0;       ///< Images that were decoded and coded.
  uint64_t kept = 0;        ///< Codes that were there, with this segment or another one.
  uint64_t skipped = 0;     ///< Snapshots without an image of the space's size.
  uint64_t left = 0;        ///< Sealed moments that have no code yet, because time was over.
};

/// Makes the codes of all sealed images of a store that have none yet, and stores them beside their
/// segments. A space is learned where an entity has none, or has twice as many snapshots as it was
/// learned from; then all codes of the entity are made anew.
///
/// A kill loses the codes of the segment at hand. It may run beside a live writer and other jobs.
/// Errors: those of StoreReader::open; kCancelled on `stop`; kUnavailable, kResourceExhausted. An
/// entity that cannot be decoded is logged and left out.
/// Source: docs/recall.md, section "Codes".
Result<std::vector<EntityCoding>> make_codes(const std::filesystem::path& store,
                                             const ModelLoader& loader, const CodesOptions& options,
                                             const ProgressSink& progress,
                                             const std::stop_token& stop);

}  // namespace engram::ltm
