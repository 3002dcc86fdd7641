// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <list>
#include <memory>
#include <optional>
#include <queue>
#include <vector>

#include "datasets/mcap/file_map.h"

namespace engram::datasets::mcap {

/// All messages of a file in the order of their log times; of one time, in that of the file.
///
/// Memory: the regions that overlap in time, at most `memory_bytes` or the largest one; of what
/// overlaps beyond that 16 bytes per message, and reading it again. Threading: one thread. The file
/// must outlive it.
class OrderedMessages {
 public:
  static constexpr uint64_t kMemoryBytes = 256 << 20;

  OrderedMessages(FileWindow& file, std::vector<Region> regions,
                  uint64_t memory_bytes = kMemoryBytes);

  /// Valid until the next call. Regions that cannot be read are left out and told in `report`.
  /// Errors: kUnavailable where the disk fails.
  Result<std::optional<MessageRecord>> next(ReadingReport& report);

 private:
  struct Open {
    Region region;
    std::vector<LoadedRegion::Entry> entries;  ///< In the order of time.
    size_t next = 0;
    LoadedRegion loaded;  ///< Without bytes where they were given up.
  };
  struct Head {
    uint64_t time;
    size_t index;  ///< Of opened_.
  };
  struct IsLater {
    bool operator()(const Head& a, const Head& b) const {
      return a.time != b.time ? a.time > b.time : a.index > b.index;
    }
  };

  Status open_next(ReadingReport& report);
  Status bring(size_t index);
  void give_up_others(size_t index);

  FileWindow& file_;
  uint64_t most_bytes_;
  std::vector<Region> regions_;                ///< In the order of their first times.
  std::vector<std::unique_ptr<Open>> opened_;  ///< Null where all was read.
  std::priority_queue<Head, std::vector<Head>, IsLater> heads_;
  std::list<size_t> in_memory_;  ///< Indices of opened_, the last used one first.
  uint64_t memory_bytes_ = 0;
  std::optional<size_t> finished_;  ///< To let go of at the next call.
};

}  // namespace engram::datasets::mcap
