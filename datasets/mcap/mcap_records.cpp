// SPDX-License-Identifier: Apache-2.0
#include "datasets/mcap/mcap_records.h"

#include <zlib.h>

#include <cstring>

#include "ltm/core/byte_fields.h"

namespace engram::datasets::mcap {

namespace {

/// Reads the fields of a record, and tells the first one that does not fit.
class Fields {
 public:
  Fields(std::string_view record, std::span<const std::byte> content)
      : record_(record), size_(content.size()), in_(content) {}

  template <typename T>
  T number() {
    return in_.number<T>();
  }

  std::string text() { return std::string(in_.text()); }

  std::span<const std::byte> long_bytes() { return in_.bytes(number<uint64_t>()); }

  std::span<const std::byte> rest() { return in_.bytes(in_.rest()); }

  /// Calls `read` for the entries of a map until its bytes are used up.
  template <typename F>
  void map(F read) {
    Fields entries(record_, in_.sized());
    while (entries.in_.rest() > 0) read(entries);
    if (status().ok()) in_map_ = entries.status();
  }

  std::map<std::string, std::string> texts() {
    std::map<std::string, std::string> result;
    map([&](Fields& entries) {
      std::string key = entries.text();
      result[std::move(key)] = entries.text();
    });
    return result;
  }

  [[nodiscard]] uint64_t at() const { return in_.at(); }
  [[nodiscard]] Status status() const {
    if (!in_map_.ok() || in_.is_whole()) return in_map_;
    return data_loss("{} record: byte {} of {}, a field needs {} more", record_, in_.at(), size_,
                     in_.missing());
  }

 private:
  std::string_view record_;
  uint64_t size_;
  FieldReader in_;
  Status in_map_;  ///< What is missing in a map.
};

template <typename T>
Result<T> checked(const Fields& fields, T record) {
  if (!fields.status().ok()) return fields.status();
  return record;
}

template <typename T>
void put(std::string& out, T value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  out.append(bytes, sizeof(T));
}

void put(std::string& out, const std::string& text) {
  put(out, static_cast<uint32_t>(text.size()));
  out += text;
}

/// Appends a record with the content that `write` appends.
template <typename F>
void put_record(std::string& out, Opcode opcode, F write) {
  out += static_cast<char>(opcode);
  const size_t length_at = out.size();
  put(out, uint64_t{0});
  write();
  const uint64_t length = out.size() - length_at - sizeof(uint64_t);
  std::memcpy(out.data() + length_at, &length, sizeof(length));
}

/// Appends a map, with its length in bytes.
template <typename K, typename V>
void put(std::string& out, const std::map<K, V>& map) {
  const size_t length_at = out.size();
  put(out, uint32_t{0});
  for (const auto& [key, value] : map) {
    put(out, key);
    put(out, value);
  }
  const auto length = static_cast<uint32_t>(out.size() - length_at - sizeof(uint32_t));
  std::memcpy(out.data() + length_at, &length, sizeof(length));
}

}  // namespace

Result<HeaderRecord> read_header(std::span<const std::byte> content) {
  Fields fields("header", content);
  HeaderRecord record;
  record.profile = fields.text();
  record.library = fields.text();
  return checked(fields, std::move(record));
}

Result<FooterRecord> read_footer(std::span<const std::byte> content) {
  Fields fields("footer", content);
  FooterRecord record;
  record.summary_start = fields.number<uint64_t>();
  record.summary_offset_start = fields.number<uint64_t>();
  record.summary_crc = fields.number<uint32_t>();
  return checked(fields, record);
}

Result<SchemaRecord> read_schema(std::span<const std::byte> content) {
  Fields fields("schema", content);
  SchemaRecord record;
  record.id = fields.number<uint16_t>();
  record.name = fields.text();
  record.encoding = fields.text();
  record.data = fields.text();
  return checked(fields, std::move(record));
}

Result<ChannelRecord> read_channel(std::span<const std::byte> content) {
  Fields fields("channel", content);
  ChannelRecord record;
  record.id = fields.number<uint16_t>();
  record.schema_id = fields.number<uint16_t>();
  record.topic = fields.text();
  record.message_encoding = fields.text();
  record.metadata = fields.texts();
  return checked(fields, std::move(record));
}

Result<MessageRecord> read_message(std::span<const std::byte> content) {
  Fields fields("message", content);
  MessageRecord record;
  record.channel_id = fields.number<uint16_t>();
  record.sequence = fields.number<uint32_t>();
  record.log_time = fields.number<uint64_t>();
  record.publish_time = fields.number<uint64_t>();
  record.data = fields.rest();
  return checked(fields, record);
}

Result<ChunkRecord> read_chunk(std::span<const std::byte> content) {
  Fields fields("chunk", content);
  ChunkRecord record;
  record.start_time = fields.number<uint64_t>();
  record.end_time = fields.number<uint64_t>();
  record.uncompressed_size = fields.number<uint64_t>();
  record.uncompressed_crc = fields.number<uint32_t>();
  record.compression = fields.text();
  record.records_size = fields.number<uint64_t>();
  record.records_at = fields.at();
  return checked(fields, std::move(record));
}

Result<StatisticsRecord> read_statistics(std::span<const std::byte> content) {
  Fields fields("statistics", content);
  StatisticsRecord record;
  record.message_count = fields.number<uint64_t>();
  record.schema_count = fields.number<uint16_t>();
  record.channel_count = fields.number<uint32_t>();
  record.attachment_count = fields.number<uint32_t>();
  record.metadata_count = fields.number<uint32_t>();
  record.chunk_count = fields.number<uint32_t>();
  record.start_time = fields.number<uint64_t>();
  record.end_time = fields.number<uint64_t>();
  fields.map([&](Fields& entries) {
    const auto id = entries.number<uint16_t>();
    record.channel_message_counts[id] = entries.number<uint64_t>();
  });
  return checked(fields, std::move(record));
}

Result<MetadataRecord> read_metadata(std::span<const std::byte> content) {
  Fields fields("metadata", content);
  MetadataRecord record;
  record.name = fields.text();
  record.metadata = fields.texts();
  return checked(fields, std::move(record));
}

Result<AttachmentRecord> read_attachment(std::span<const std::byte> content) {
  Fields fields("attachment", content);
  AttachmentRecord record;
  record.log_time = fields.number<uint64_t>();
  record.create_time = fields.number<uint64_t>();
  record.name = fields.text();
  record.media_type = fields.text();
  record.data = fields.long_bytes();
  const uint64_t end = fields.at();
  const auto needed = fields.number<uint32_t>();
  if (!fields.status().ok()) return fields.status();
  const uint32_t crc = needed == 0 ? 0 : crc32_of(content.first(end));
  if (crc != needed)
    return data_loss("CRC of the attachment is {:08x}, the file says {:08x}", crc, needed);
  return record;
}

Result<uint32_t> read_data_end(std::span<const std::byte> content) {
  Fields fields("data end", content);
  const auto crc = fields.number<uint32_t>();
  return checked(fields, crc);
}

RecordStart read_start(std::span<const std::byte> bytes) {
  ENGRAM_CHECK(bytes.size() >= kRecordStartBytes, "{} bytes", bytes.size());
  RecordStart start{static_cast<Opcode>(bytes[0]), 0};
  std::memcpy(&start.length, bytes.data() + 1, sizeof(start.length));
  return start;
}

void append(std::string& out, const HeaderRecord& record) {
  put_record(out, Opcode::kHeader, [&] {
    put(out, record.profile);
    put(out, record.library);
  });
}

void append(std::string& out, const FooterRecord& record) {
  put_record(out, Opcode::kFooter, [&] {
    put(out, record.summary_start);
    put(out, record.summary_offset_start);
    put(out, record.summary_crc);
  });
}

void append(std::string& out, const SchemaRecord& record) {
  put_record(out, Opcode::kSchema, [&] {
    put(out, record.id);
    put(out, record.name);
    put(out, record.encoding);
    put(out, record.data);
  });
}

void append(std::string& out, const ChannelRecord& record) {
  put_record(out, Opcode::kChannel, [&] {
    put(out, record.id);
    put(out, record.schema_id);
    put(out, record.topic);
    put(out, record.message_encoding);
    put(out, record.metadata);
  });
}

void append(std::string& out, const MessageRecord& record) {
  put_record(out, Opcode::kMessage, [&] {
    put(out, record.channel_id);
    put(out, record.sequence);
    put(out, record.log_time);
    put(out, record.publish_time);
    out += as_text(record.data);
  });
}

void append(std::string& out, const ChunkRecord& record, std::span<const std::byte> records) {
  put_record(out, Opcode::kChunk, [&] {
    put(out, record.start_time);
    put(out, record.end_time);
    put(out, record.uncompressed_size);
    put(out, record.uncompressed_crc);
    put(out, record.compression);
    put(out, uint64_t{records.size()});
    out += as_text(records);
  });
}

void append(std::string& out, const ChunkIndexRecord& record) {
  put_record(out, Opcode::kChunkIndex, [&] {
    put(out, record.start_time);
    put(out, record.end_time);
    put(out, record.chunk_offset);
    put(out, record.chunk_length);
    put(out, record.message_index_offsets);
    put(out, record.message_index_length);
    put(out, record.compression);
    put(out, record.compressed_size);
    put(out, record.uncompressed_size);
  });
}

void append(std::string& out, const StatisticsRecord& record) {
  put_record(out, Opcode::kStatistics, [&] {
    put(out, record.message_count);
    put(out, record.schema_count);
    put(out, record.channel_count);
    put(out, record.attachment_count);
    put(out, record.metadata_count);
    put(out, record.chunk_count);
    put(out, record.start_time);
    put(out, record.end_time);
    put(out, record.channel_message_counts);
  });
}

void append(std::string& out, const MetadataRecord& record) {
  put_record(out, Opcode::kMetadata, [&] {
    put(out, record.name);
    put(out, record.metadata);
  });
}

void append(std::string& out, const AttachmentRecord& record) {
  put_record(out, Opcode::kAttachment, [&] {
    const size_t start = out.size();
    put(out, record.log_time);
    put(out, record.create_time);
    put(out, record.name);
    put(out, record.media_type);
    put(out, uint64_t{record.data.size()});
    out += as_text(record.data);
    put(out, crc32_of(as_bytes(std::string_view(out).substr(start))));
  });
}

void append_attachment_index(std::string& out, const AttachmentRecord& record, uint64_t offset,
                             uint64_t length) {
  put_record(out, Opcode::kAttachmentIndex, [&] {
    put(out, offset);
    put(out, length);
    put(out, record.log_time);
    put(out, record.create_time);
    put(out, uint64_t{record.data.size()});
    put(out, record.name);
    put(out, record.media_type);
  });
}

void append_data_end(std::string& out, uint32_t data_crc) {
  put_record(out, Opcode::kDataEnd, [&] { put(out, data_crc); });
}

void append_metadata_index(std::string& out, uint64_t offset, uint64_t length,
                           std::string_view name) {
  put_record(out, Opcode::kMetadataIndex, [&] {
    put(out, offset);
    put(out, length);
    put(out, std::string(name));
  });
}

void append_summary_offset(std::string& out, Opcode group, uint64_t start, uint64_t length) {
  put_record(out, Opcode::kSummaryOffset, [&] {
    put(out, static_cast<uint8_t>(group));
    put(out, start);
    put(out, length);
  });
}

void append_message_index(std::string& out, uint16_t channel_id,
                          const std::vector<std::pair<uint64_t, uint64_t>>& entries) {
  put_record(out, Opcode::kMessageIndex, [&] {
    put(out, channel_id);
    put(out, static_cast<uint32_t>(entries.size() * 2 * sizeof(uint64_t)));
    for (const auto& [time, offset] : entries) {
      put(out, time);
      put(out, offset);
    }
  });
}

uint32_t crc32_of(std::span<const std::byte> bytes, uint32_t crc) {
  return static_cast<uint32_t>(
      ::crc32_z(crc, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace engram::datasets::mcap
