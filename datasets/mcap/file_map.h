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

/// The place of an attachment's content in the file.
struct AttachmentPlace {
  uint64_t offset = 0;
  uint64_t length = 0;
  uint64_t log_time = 0;  ///< Unit: ns.
};

/// Describes a file: its channels and schemas, and where its messages are.
///
/// Memory: about 40 bytes per chunk, or per MiB of messages outside of chunks, and the
/// descriptions.
struct FileMap {
  HeaderRecord header;
  std::map<uint16_t, SchemaRecord> schemas;
  std::map<uint16_t, ChannelRecord> channels;
  std::vector<MetadataRecord> metadata;
  std::vector<Region> regions;               ///< In the order of the file.
  std::vector<AttachmentPlace> attachments;  ///< In the order of time.
  std::optional<StatisticsRecord> statistics;
  std::map<uint16_t, size_t> first_region;  ///< The first region with a message, by channel.
};

/// The messages of a region, with the schemas and channels that are defined in it.
struct LoadedRegion : RegionMessages {
  std::vector<SchemaRecord> schemas;
  std::vector<ChannelRecord> channels;
};

/// Reads and checks one region.
/// Errors: kDataLoss naming file, offset, what was found and what was needed.
Result<LoadedRegion> load_region(FileWindow& file, const Region& region);

/// Returns the message at the start of `bytes`, where load_region found it.
[[nodiscard]] MessageRecord message_at(std::span<const std::byte> bytes);
/// Returns the message at `entry`.
[[nodiscard]] inline MessageRecord message_at(const LoadedRegion& loaded,
                                              const RegionMessages::Entry& entry) {
  return message_at(loaded.bytes.bytes().subspan(entry.offset));
}

/// Scans all records; what is missing or damaged is counted in `report`. Chunks are opened only if
/// the summary does not describe their contents.
/// Errors: kInvalidArgument if it is not an MCAP file; kDataLoss if it has no header.
Result<FileMap> map_file(FileWindow& file, ReadingReport& report);

}  // namespace engram::datasets::mcap
