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

/// A part of a file whose messages are read together: a chunk, or consecutive messages outside of
/// chunks.
struct Region {
  uint64_t offset = 0;
  uint64_t length = 0;
  uint64_t start_time = 0;  ///< Unit: ns.
  uint64_t messages = 0;    ///< The number that indexes give; 0 if they give none.
  bool is_chunk = false;
};

/// The messages of a region that is in memory.
struct RegionMessages {
  struct Entry {
    uint64_t time;    ///< Unit: ns.
    uint64_t offset;  ///< Offset of the record in `bytes`.
  };
  Buffer bytes;
  std::vector<Entry> entries;  ///< In the order of the file.
};

/// Returns all messages of a file in the order of their times; at equal times, in that of the file.
///
/// Memory: the regions that overlap in time, up to `memory_bytes` or the largest region. Regions
/// that overlap beyond that cost 16 bytes per message and are read again. Threading: one thread.
class OrderedRegions {
 public:
  static constexpr uint64_t kMemoryBytes = 256 << 20;

  /// Reads a region into memory. kUnavailable ends the reading; other errors skip only the region.
  using Load = std::function<Result<RegionMessages>(const Region&)>;

  OrderedRegions(Load load, std::vector<Region> regions, uint64_t memory_bytes = kMemoryBytes);

  /// Returns the bytes from the record of the next message to the end of its region; they are valid
  /// until the next call. Regions that cannot be read are left out and counted in `report`.
  /// Errors: kUnavailable if the disk fails.
  Result<std::optional<std::span<const std::byte>>> next(ReadingReport& report);

 private:
  struct Open {
    Region region;
    std::vector<RegionMessages::Entry> entries;  ///< In the order of time.
    size_t next = 0;
    Buffer bytes;  ///< Empty if they were released to save memory.
  };
  struct Head {
    uint64_t time;
    size_t index;  ///< Index into opened_.
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
  std::vector<std::unique_ptr<Open>> opened_;  ///< Null for regions that are finished.
  std::priority_queue<Head, std::vector<Head>, IsLater> heads_;
  std::list<size_t> in_memory_;  ///< Indices into opened_, the most recently used first.
  uint64_t memory_bytes_ = 0;
  std::optional<size_t> finished_;  ///< The region to release at the next call.
};

}  // namespace engram::datasets
