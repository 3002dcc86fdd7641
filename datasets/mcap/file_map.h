// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/mcap/mcap_records.h"
#include "datasets/recordings/file_window.h"
#include "datasets/recordings/ordered_regions.h"

namespace engram::datasets::mcap {

/// Where the content of an attachment lies.
struct AttachmentPlace {
  uint64_t offset = 0;
  uint64_t length = 0;
  uint64_t log_time = 0;  ///< Unit: ns.
};

/// Everything that a file says of itself: where its messages lie, and what they are.
///
/// Memory: about 40 bytes per chunk, or MiB of messages outside of chunks, and the descriptions.
struct FileMap {
  HeaderRecord header;
  std::map<uint16_t, SchemaRecord> schemas;
  std::map<uint16_t, ChannelRecord> channels;
  std::vector<MetadataRecord> metadata;
  std::vector<Region> regions;               ///< In the order of the file.
  std::vector<AttachmentPlace> attachments;  ///< In the order of time.
  std::optional<StatisticsRecord> statistics;
  std::map<uint16_t, size_t> first_region;  ///< That has a message of a channel.
};

/// With what describes them there.
struct LoadedRegion : RegionMessages {
  std::vector<SchemaRecord> schemas;
  std::vector<ChannelRecord> channels;
};

/// Reads and checks one region.
/// Errors: kDataLoss naming file, offset, what was found and what was needed.
Result<LoadedRegion> load_region(FileWindow& file, const Region& region);

/// The message at the start of `bytes`, where load_region found it.
[[nodiscard]] MessageRecord message_at(std::span<const std::byte> bytes);
/// The one at `entry`.
[[nodiscard]] inline MessageRecord message_at(const LoadedRegion& loaded,
                                              const RegionMessages::Entry& entry) {
  return message_at(loaded.bytes.bytes().subspan(entry.offset));
}

/// Walks over all records; what is missing or damaged is told in `report`. Chunks are opened only
/// where the summary does not say what is in them.
/// Errors: kInvalidArgument where it is no MCAP file; kDataLoss where it has no header.
Result<FileMap> map_file(FileWindow& file, ReadingReport& report);

}  // namespace engram::datasets::mcap
