// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "ltm/store/manifest.h"
#include "ltm/store/segment_reader.h"

namespace engram::ltm {

/// Receives rows in file order: the rows of one snapshot, or, if `times` is an error, consecutive
/// rows whose times cannot be read.
using RowVisit = std::function<Status(const RowSpan& span, const Status& times)>;

/// Visits all rows of an entity in a segment that may be damaged. Memory is bounded. Snapshots come
/// in the order of time only if the file is undamaged.
/// Errors: kNotFound; kDataLoss if the entity's rows cannot be counted; those of `visit`.
Status walk_rows(SegmentReader& reader, const MemoryId& entity, const RowVisit& visit);

/// The manifest entry of a segment, made from the file alone.
struct DescribedSegment {
  SegmentInfo info;      ///< Has no `file`. Counts only readable content.
  bool is_whole = true;  ///< True if every value in the segment can be read.
  /// One error for each group that cannot be read, and for the types.
  std::vector<Status> damaged;
};

/// Reads a whole segment. Errors: kDataLoss if it is not a segment; kFailedPrecondition if its
/// format is newer than this program's; kUnavailable.
Result<DescribedSegment> describe_segment(const std::filesystem::path& file);

}  // namespace engram::ltm
