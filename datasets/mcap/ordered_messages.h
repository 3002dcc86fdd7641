// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <optional>
#include <vector>

#include "datasets/mcap/file_map.h"

namespace engram::datasets::mcap {

/// Returns all messages of a file in the order of their log times; see OrderedRegions.
///
/// The file must outlive it.
class OrderedMessages {
 public:
  OrderedMessages(FileWindow& file, std::vector<Region> regions,
                  uint64_t memory_bytes = OrderedRegions::kMemoryBytes)
      : regions_(
            [&file](const Region& region) -> Result<RegionMessages> {
              ENGRAM_ASSIGN_OR_RETURN(LoadedRegion loaded, load_region(file, region));
              return RegionMessages(std::move(loaded));
            },
            std::move(regions), memory_bytes) {}

  /// The result is valid until the next call. Errors: those of OrderedRegions::next.
  Result<std::optional<MessageRecord>> next(ReadingReport& report) {
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes, regions_.next(report));
    return bytes ? std::optional(message_at(*bytes)) : std::nullopt;
  }

 private:
  OrderedRegions regions_;
};

}  // namespace engram::datasets::mcap
