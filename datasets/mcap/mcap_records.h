// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/status.h"

namespace engram::datasets::mcap {

inline constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
/// Size of the opcode and length in front of every record.
inline constexpr uint64_t kRecordStartBytes = 9;
/// The maximum size of a record or chunk that is accepted. Unit: bytes.
inline constexpr uint64_t kMaxRecordBytes = uint64_t{512} << 20;

enum class Opcode : uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0a,
  kStatistics = 0x0b,
  kMetadata = 0x0c,
  kMetadataIndex = 0x0d,
  kSummaryOffset = 0x0e,
  kDataEnd = 0x0f,
};

// The records as in the specification. Unit of times: ns.

struct HeaderRecord {
  std::string profile;
  std::string library;
};

struct FooterRecord {
  static constexpr uint64_t kBytes = 20;
  uint64_t summary_start = 0;
  uint64_t summary_offset_start = 0;
  uint32_t summary_crc = 0;
};

struct SchemaRecord {
  uint16_t id = 0;
  std::string name;
  std::string encoding;
  std::string data;

  friend bool operator==(const SchemaRecord&, const SchemaRecord&) = default;
};

struct ChannelRecord {
  uint16_t id = 0;
  uint16_t schema_id = 0;  ///< 0 for none.
  std::string topic;
  std::string message_encoding;
  std::map<std::string, std::string> metadata;

  friend bool operator==(const ChannelRecord&, const ChannelRecord&) = default;
};

struct MessageRecord {
  static constexpr uint64_t kStartBytes = 22;
  uint16_t channel_id = 0;
  uint32_t sequence = 0;
  uint64_t log_time = 0;
  uint64_t publish_time = 0;
  std::span<const std::byte> data;
};

struct ChunkRecord {
  uint64_t start_time = 0;
  uint64_t end_time = 0;
  uint64_t uncompressed_size = 0;
  uint32_t uncompressed_crc = 0;
  std::string compression;
  uint64_t records_size = 0;
  uint64_t records_at = 0;  ///< Offset in the content of the record; not written.
};

struct ChunkIndexRecord {
  uint64_t start_time = 0;
  uint64_t end_time = 0;
  uint64_t chunk_offset = 0;
  uint64_t chunk_length = 0;
  std::map<uint16_t, uint64_t> message_index_offsets;
  uint64_t message_index_length = 0;
  std::string compression;
  uint64_t compressed_size = 0;
  uint64_t uncompressed_size = 0;
};

struct StatisticsRecord {
  uint64_t message_count = 0;
  uint16_t schema_count = 0;
  uint32_t channel_count = 0;
  uint32_t attachment_count = 0;
  uint32_t metadata_count = 0;
  uint32_t chunk_count = 0;
  uint64_t start_time = 0;
  uint64_t end_time = 0;
  std::map<uint16_t, uint64_t> channel_message_counts;
};

struct MetadataRecord {
  std::string name;
  std::map<std::string, std::string> metadata;

  friend bool operator==(const MetadataRecord&, const MetadataRecord&) = default;
};

struct AttachmentRecord {
  uint64_t log_time = 0;
  uint64_t create_time = 0;  ///< 0 if not known.
  std::string name;
  std::string media_type;
  std::span<const std::byte> data;
};

// Each function reads the content of a record; bytes after the known fields are ignored. Messages
// and attachments share `content`. Errors: kDataLoss saying what was read, found and needed.
Result<HeaderRecord> read_header(std::span<const std::byte> content);
Result<FooterRecord> read_footer(std::span<const std::byte> content);
Result<SchemaRecord> read_schema(std::span<const std::byte> content);
Result<ChannelRecord> read_channel(std::span<const std::byte> content);
Result<MessageRecord> read_message(std::span<const std::byte> content);
/// The first bytes of a chunk are enough.
Result<ChunkRecord> read_chunk(std::span<const std::byte> content);
Result<StatisticsRecord> read_statistics(std::span<const std::byte> content);
Result<MetadataRecord> read_metadata(std::span<const std::byte> content);
/// The checksum of the attachment is verified.
Result<AttachmentRecord> read_attachment(std::span<const std::byte> content);
Result<uint32_t> read_data_end(std::span<const std::byte> content);

/// The start of a record: opcode and length. It needs at least nine bytes (checked).
struct RecordStart {
  Opcode opcode;
  uint64_t length;
};
[[nodiscard]] RecordStart read_start(std::span<const std::byte> bytes);

// Each function appends a whole record.
void append(std::string& out, const HeaderRecord& record);
void append(std::string& out, const FooterRecord& record);
void append(std::string& out, const SchemaRecord& record);
void append(std::string& out, const ChannelRecord& record);
void append(std::string& out, const MessageRecord& record);
void append(std::string& out, const ChunkRecord& record, std::span<const std::byte> records);
void append(std::string& out, const ChunkIndexRecord& record);
void append(std::string& out, const StatisticsRecord& record);
void append(std::string& out, const MetadataRecord& record);
void append(std::string& out, const AttachmentRecord& record);
/// Appends the index of an attachment that was written at `offset` with `length` bytes.
void append_attachment_index(std::string& out, const AttachmentRecord& record, uint64_t offset,
                             uint64_t length);
void append_data_end(std::string& out, uint32_t data_crc);
void append_metadata_index(std::string& out, uint64_t offset, uint64_t length,
                           std::string_view name);
void append_summary_offset(std::string& out, Opcode group, uint64_t start, uint64_t length);
/// `entries` are pairs of log time and offset in the uncompressed chunk.
void append_message_index(std::string& out, uint16_t channel_id,
                          const std::vector<std::pair<uint64_t, uint64_t>>& entries);

/// CRC-32 as in zlib. `crc` is the checksum of the bytes before.
[[nodiscard]] uint32_t crc32_of(std::span<const std::byte> bytes, uint32_t crc = 0);

}  // namespace engram::datasets::mcap
