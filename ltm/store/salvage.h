// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "ltm/store/finding.h"
#include "ltm/store/journal.h"
#include "ltm/store/manifest.h"

namespace engram::ltm {

/// The result of salvaging a damaged segment.
struct SalvagedSegment {
  struct Counts {
    uint64_t saved = 0;  ///< Snapshots.
    uint64_t lost = 0;
  };

  std::vector<SegmentInfo> made;  ///< New segments, in order. Empty if nothing is readable.
  std::map<MemoryId, Counts> entities;
  std::vector<Finding> findings;  ///< One fault for each entity that lost snapshots.
};

/// Writes every readable snapshot of a segment into new segments below `target`, with groups of
/// images decoded. Memory is bounded, so one segment may become several.
/// `told` is the manifest's entry of the segment. `types` are used if the segment's own cannot be
/// read. `next_file` returns the name of each new segment.
/// Errors: kFailedPrecondition if the format is newer, or if the decoder of a group is not
/// installed; kUnavailable, kResourceExhausted, kCancelled.
Result<SalvagedSegment> salvage_segment(const std::filesystem::path& source,
                                        const SegmentInfo& told, const SegmentTypes& types,
                                        const std::filesystem::path& target,
                                        const std::function<std::string()>& next_file,
                                        const std::stop_token& stop);

/// The result of copying a journal.
struct SalvagedJournal {
  JournalScan scan;
  uint64_t undecodable = 0;  ///< Whole frames whose payload does not decode.
  std::map<MemoryId, uint64_t> snapshots;
  std::map<MemoryId, uint64_t> too_late;  ///< Snapshots after `latest`.
};

/// Copies the whole frames of a journal into a journal of the same number below `target`, but for
/// snapshots after `latest`.
/// Errors: kAlreadyExists, kUnavailable, kResourceExhausted.
Result<SalvagedJournal> copy_journal(const std::filesystem::path& source,
                                     const std::filesystem::path& target, uint64_t number,
                                     std::optional<Time> latest = {});

}  // namespace engram::ltm
