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

/// What a segment is to hold of one entity.
struct RecordedEntity {
  std::vector<PackedSnapshot> snapshots;  ///< In the order of time.
  uint64_t trailing_dropped = 0;          ///< After the last snapshot.
  uint64_t trailing_dropped_bytes = 0;
  SealRules rules;  ///< What becomes of images and numbers that are stored singly.
};

/// Writes a whole segment file of recorded snapshots; the caller publishes it.
///
/// `types` are those that the values came under. Returns the segment with everything but its
/// `file`.
/// Errors: kUnavailable, kInvalidArgument; kDataLoss where groups of images that are not whole any
/// more do not decode.
/// Source: docs/format.md, section "Segment".
Result<SegmentInfo> write_recorded_segment(const std::filesystem::path& file,
                                           const std::map<MemoryId, RecordedEntity>& entities,
                                           const SegmentTypes& types = {});

/// Writes a whole segment file of one entity's latents, all of one model version, in the order of
/// time; the caller publishes it. Returns the segment with everything but its `file`. The bytes of
/// a block are stored once, whole also where rows of it are missing, and so they count in
/// `stored_bytes`.
/// Errors: kUnavailable; kInvalidArgument where latents have places that no block can have.
Result<SegmentInfo> write_latent_segment(const std::filesystem::path& file, const MemoryId& entity,
                                         const std::vector<LatentSnapshot>& snapshots);

/// Adds what `bytes` of the segment its entities do not take to their shares, evenly.
void spread_overhead(SegmentInfo& info);

/// Adds the errors of one instance.
void add_to_sums(LatentSums& sums, const MeasuredError& error);

}  // namespace engram::ltm
