// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <map>
#include <vector>

#include "datasets/recordings/file_window.h"
#include "datasets/recordings/ordered_regions.h"
#include "datasets/rosbag/bag_records.h"

namespace engram::datasets::rosbag {

/// Everything that a bag says of itself: where its messages lie, and what they are.
///
/// Memory: 40 bytes per chunk, or MiB of messages outside of chunks, and the connections.
struct BagMap {
  std::map<uint32_t, Connection> connections;
  std::map<uint32_t, uint64_t> messages;    ///< Of a connection; fewer where indexes are missing.
  std::vector<Region> regions;              ///< In the order of the file.
  std::map<uint32_t, size_t> first_region;  ///< That has a message of a connection.
};

/// A region in memory, with what describes its messages there.
struct LoadedRegion : RegionMessages {
  std::vector<Connection> connections;
};

/// Reads and checks one region. What behind a damaged record cannot be found is left out, and told
/// in `problem`; empty: nothing is.
/// Errors: kDataLoss naming file, offset, what was found and what was needed; kUnavailable.
Result<LoadedRegion> load_region(FileWindow& file, const Region& region, std::string& problem);

/// The message at the start of `bytes`, where load_region found it.
[[nodiscard]] Message message_at(std::span<const std::byte> bytes);

/// Walks over all records; what is missing or damaged is told in `report`. Chunks are opened only
/// where their indexes do not say what is in them. Messages behind the last chunk, where a recorder
/// was killed, are found.
/// Errors: kInvalidArgument where it is no bag of version 2.0, or an encrypted one; kDataLoss where
/// it has no bag header; kUnavailable.
Result<BagMap> map_bag(FileWindow& file, ReadingReport& report);

}  // namespace engram::datasets::rosbag
