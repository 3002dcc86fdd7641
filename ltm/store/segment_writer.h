// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <vector>

#include "ltm/codec/seal_rules.h"
#include "ltm/store/latent.h"
#include "ltm/store/manifest.h"
#include "ltm/store/packed_snapshot.h"

namespace engram::ltm {

/// The content of one entity in a new segment.
struct RecordedEntity {
  std::vector<PackedSnapshot> snapshots;  ///< In the order of time.
  uint64_t trailing_dropped = 0;          ///< Snapshots that filters dropped after the last one.
  uint64_t trailing_dropped_bytes = 0;
  SealRules rules;  ///< How single images and numbers are stored.
};

/// Writes a whole segment file of recorded snapshots. The caller publishes it.
///
/// `types` are the types that the values were declared with. Returns the segment without its
/// `file`.
/// Errors: kUnavailable, kInvalidArgument; kDataLoss if an incomplete group of images does not
/// decode.
/// Source: docs/format.md, section "Segment".
Result<SegmentInfo> write_recorded_segment(const std::filesystem::path& file,
                                           const std::map<MemoryId, RecordedEntity>& entities,
                                           const SegmentTypes& types = {});

/// Writes a whole segment file with the latents of one entity, all of one model version, in the
/// order of time. The caller publishes it. Returns the segment without its `file`. The bytes of a
/// block are stored once and completely, even if some of its rows are missing, and count in
/// `stored_bytes`.
/// Errors: kUnavailable; kInvalidArgument if latents have a place that is not valid in a block.
Result<SegmentInfo> write_latent_segment(const std::filesystem::path& file, const MemoryId& entity,
                                         const std::vector<LatentSnapshot>& snapshots);

/// Distributes the bytes of the segment that belong to no entity evenly over its entities' shares.
void spread_overhead(SegmentInfo& info);

/// Adds the measured errors of one instance to `sums`.
void add_to_sums(LatentSums& sums, const MeasuredError& error);

}  // namespace engram::ltm
