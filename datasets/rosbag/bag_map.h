// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <map>
#include <vector>

#include "datasets/recordings/file_window.h"
#include "datasets/recordings/ordered_regions.h"
#include "datasets/rosbag/bag_records.h"

namespace engram::datasets::rosbag {

/// Describes a bag: its connections, and where its messages are.
///
/// Memory: 40 bytes per chunk, or per MiB of messages outside of chunks, and the connections.
struct BagMap {
  std::map<uint32_t, Connection> connections;
  std::map<uint32_t, uint64_t> messages;    ///< By connection; too few if indexes are missing.
  std::vector<Region> regions;              ///< In the order of the file.
  std::map<uint32_t, size_t> first_region;  ///< The first region with a message, by connection.
};

/// The messages of a region, with the connections that are defined in it.
struct LoadedRegion : RegionMessages {
  std::vector<Connection> connections;
};

/// Reads and checks one region. Messages after a damaged record that cannot be found are left out,
/// and `problem` says so; it is empty if nothing is left out.
/// Errors: kDataLoss naming file, offset, what was found and what was needed; kUnavailable.
Result<LoadedRegion> load_region(FileWindow& file, const Region& region, std::string& problem);

/// Returns the message at the start of `bytes`, where load_region found it.
[[nodiscard]] Message message_at(std::span<const std::byte> bytes);

/// Scans all records; what is missing or damaged is counted in `report`. Chunks are opened only if
/// their indexes do not describe their contents. Messages after the last chunk, which remain if a
/// recorder was killed, are found.
/// Errors: kInvalidArgument if it is not a bag of version 2.0, or is encrypted; kDataLoss if it has
/// no bag header; kUnavailable.
Result<BagMap> map_bag(FileWindow& file, ReadingReport& report);

}  // namespace engram::datasets::rosbag
