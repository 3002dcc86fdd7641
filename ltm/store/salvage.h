// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <stop_token>
#include <string>
#include <vector>

#include "ltm/store/finding.h"
#include "ltm/store/journal.h"
#include "ltm/store/manifest.h"

namespace engram::ltm {

/// What became of a damaged segment.
struct SalvagedSegment {
  struct Counts {
    uint64_t saved = 0;  ///< Snapshots.
    uint64_t lost = 0;
  };

  std::vector<SegmentInfo> made;  ///< In their order; none where nothing is whole.
  std::map<MemoryId, Counts> entities;
  std::vector<Finding> findings;  ///< A fault per entity that lost something.
};

/// Writes every snapshot of a segment that can be read whole, groups of images decoded, into new
/// segments below `target`.
/// `told` is what the manifest says of it, `types` are to be taken where its own cannot be read;
/// `next_file` names each new one. What is written at once
/// is bounded.
/// Errors: kFailedPrecondition where the format is newer, or the decoder of a group is not
/// installed; kUnavailable, kResourceExhausted,
/// kCancelled.
Result<SalvagedSegment> salvage_segment(const std::filesystem::path& source,
                                        const SegmentInfo& told, const SegmentTypes& types,
                                        const std::filesystem::path& target,
                                        const std::function<std::string()>& next_file,
                                        const std::stop_token& stop);

/// What became of a journal.
struct SalvagedJournal {
  JournalScan scan;
  uint64_t undecodable = 0;  ///< Whole frames that hold nothing readable.
  std::map<MemoryId, uint64_t> snapshots;
};

/// Copies the whole frames of a journal into one of the same number below `target`.
/// Errors: kAlreadyExists, kUnavailable, kResourceExhausted.
Result<SalvagedJournal> copy_journal(const std::filesystem::path& source,
                                     const std::filesystem::path& target, uint64_t number);

}  // namespace engram::ltm
