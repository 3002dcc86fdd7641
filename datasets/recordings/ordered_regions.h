// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <queue>
#include <span>
#include <vector>

#include "datasets/recordings/recording_reader.h"
#include "ltm/core/buffer.h"

namespace engram::datasets {

/// A part of a file whose messages are read together: a chunk, or messages that lie one behind the
/// other outside of chunks.
struct Region {
  uint64_t offset = 0;
  uint64_t length = 0;
  uint64_t start_time = 0;  ///< Unit: ns.
  uint64_t messages = 0;    ///< As indexes say; 0: they do not.
  bool is_chunk = false;
};

/// The messages of a region, once it is in memory.
struct RegionMessages {
  struct Entry {
    uint64_t time;    ///< Unit: ns.
    uint64_t offset;  ///< Of the record, in `bytes`.
  };
  Buffer bytes;
  std::vector<Entry> entries;  ///< In the order of the file.
};

/// All messages of a file in the order of their times; of one time, in that of the file.
///
/// Memory: the regions that overlap in time, at most `memory_bytes` or the largest one; of what
/// overlaps beyond that 16 bytes per message, and reading it again. Threading: one thread.
class OrderedRegions {
 public:
  static constexpr uint64_t kMemoryBytes = 256 << 20;

  /// Brings a region into memory. Errors: kUnavailable ends the reading, others the region's.
  using Load = std::function<Result<RegionMessages>(const Region&)>;

  OrderedRegions(Load load, std::vector<Region> regions, uint64_t memory_bytes = kMemoryBytes);

  /// From the record of the next message to the end of its region; valid until the next call.
  /// Regions that cannot be read are left out and told in `report`.
  /// Errors: kUnavailable where the disk fails.
  Result<std::optional<std::span<const std::byte>>> next(ReadingReport& report);

 private:
  struct Open {
    Region region;
    std::vector<RegionMessages::Entry> entries;  ///< In the order of time.
    size_t next = 0;
    Buffer bytes;  ///< Empty where they were given up.
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

  Load load_;
  uint64_t max_bytes_;
  std::vector<Region> regions_;                ///< In the order of their first times.
  std::vector<std::unique_ptr<Open>> opened_;  ///< Null where all was read.
  std::priority_queue<Head, std::vector<Head>, IsLater> heads_;
  std::list<size_t> in_memory_;  ///< Indices of opened_, the last used one first.
  uint64_t memory_bytes_ = 0;
  std::optional<size_t> finished_;  ///< To let go of at the next call.
};

}  // namespace engram::datasets
