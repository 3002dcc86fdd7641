// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "ltm/store/manifest.h"
#include "ltm/store/segment_reader.h"

namespace engram::ltm {

/// Receives rows in the order of the file: those of one snapshot, or, where `times` is an error,
/// neighbours whose times cannot be read.
using RowVisit = std::function<Status(const RowSpan& span, const Status& times)>;

/// Walks over all rows of an entity in a segment that may be damaged. Memory is bounded. Snapshots
/// come in the order of time in whole files only.
/// Errors: kNotFound, kDataLoss where the entity has no rows that can be counted; those of `visit`.
Status walk_rows(SegmentReader& reader, const MemoryId& entity, const RowVisit& visit);

/// A segment as a manifest would tell it, made from the file alone.
struct DescribedSegment {
  SegmentInfo info;             ///< Without `file`. Counts what can be read.
  bool is_whole = true;         ///< Every value in it can be read.
  std::vector<Status> damaged;  ///< Why groups, or the types, cannot be read: one each.
};

/// Reads a segment whole. Errors: kDataLoss where it is none; kFailedPrecondition where its format
/// is newer; kUnavailable.
Result<DescribedSegment> describe_segment(const std::filesystem::path& file);

}  // namespace engram::ltm
