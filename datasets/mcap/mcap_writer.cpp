// SPDX-License-Identifier: Apache-2.0
#include "datasets/mcap/mcap_writer.h"

#include <algorithm>

#include "datasets/mcap/mcap_compression.h"

namespace engram::datasets::mcap {

Result<McapWriter> McapWriter::create(const std::filesystem::path& path, const Options& options) {
  ENGRAM_ASSIGN_OR_RETURN(NewFile file, NewFile::create(path));
  McapWriter writer(std::move(file), options);
  std::string start(kMagic);
  append(start, HeaderRecord{options.profile, options.library});
  ENGRAM_RETURN_IF_ERROR(writer.put(start));
  return writer;
}

Status McapWriter::put(std::string_view bytes) {
  ENGRAM_RETURN_IF_ERROR(file_.append(bytes));
  crc_ = crc32_of(as_bytes(bytes), crc_);
  return {};
}

void McapWriter::add(SchemaRecord schema) {
  const uint16_t id = schema.id;
  schemas_.emplace(id, std::move(schema));
}

void McapWriter::add(ChannelRecord channel) {
  const uint16_t id = channel.id;
  channels_.emplace(id, std::move(channel));
}

void McapWriter::describe(uint16_t channel_id) {
  if (!written_channels_.insert(channel_id).second) return;
  const ChannelRecord& channel = channels_.at(channel_id);
  if (channel.schema_id != 0 && written_schemas_.insert(channel.schema_id).second)
    append(chunk_, schemas_.at(channel.schema_id));
  append(chunk_, channel);
}

Status McapWriter::write(const MessageRecord& message) {
  describe(message.channel_id);
  if (chunk_index_.empty()) chunk_start_.start_time = chunk_start_.end_time = message.log_time;
  chunk_start_.start_time = std::min(chunk_start_.start_time, message.log_time);
  chunk_start_.end_time = std::max(chunk_start_.end_time, message.log_time);
  chunk_index_[message.channel_id].emplace_back(message.log_time, chunk_.size());
  append(chunk_, message);
  if (statistics_.message_count++ == 0)
    statistics_.start_time = statistics_.end_time = message.log_time;
  statistics_.start_time = std::min(statistics_.start_time, message.log_time);
  statistics_.end_time = std::max(statistics_.end_time, message.log_time);
  ++statistics_.channel_message_counts[message.channel_id];
  return chunk_.size() < options_.chunk_bytes ? Status() : flush_chunk();
}

Status McapWriter::write(const MetadataRecord& metadata) {
  // Metadata and attachments are not allowed in chunks; closing the chunk keeps the order of
  // writes.
  ENGRAM_RETURN_IF_ERROR(flush_chunk());
  std::string record;
  append(record, metadata);
  append_metadata_index(metadata_index_, file_.size(), record.size(), metadata.name);
  ++statistics_.metadata_count;
  return put(record);
}

Status McapWriter::write(const AttachmentRecord& attachment) {
  ENGRAM_RETURN_IF_ERROR(flush_chunk());
  std::string record;
  append(record, attachment);
  append_attachment_index(attachment_index_, attachment, file_.size(), record.size());
  ++statistics_.attachment_count;
  return put(record);
}

Status McapWriter::flush_chunk() {
  if (chunk_.empty()) return {};
  chunk_start_.uncompressed_size = chunk_.size();
  chunk_start_.uncompressed_crc = crc32_of(as_bytes(chunk_));
  chunk_start_.compression = options_.compression;
  ENGRAM_ASSIGN_OR_RETURN(const std::string packed,
                          compress(options_.compression, as_bytes(chunk_)));
  ChunkIndexRecord index{chunk_start_.start_time, chunk_start_.end_time, file_.size(), 0, {}, 0,
                         options_.compression,    packed.size(),         chunk_.size()};
  std::string record;
  append(record, chunk_start_, as_bytes(packed));
  index.chunk_length = record.size();
  for (const auto& [channel, entries] : chunk_index_) {
    index.message_index_offsets[channel] = file_.size() + record.size();
    append_message_index(record, channel, entries);
  }
  index.message_index_length = record.size() - index.chunk_length;
  chunks_.push_back(std::move(index));
  chunk_.clear();
  chunk_index_.clear();
  chunk_start_ = {};
  return put(record);
}

Status McapWriter::put_summary() {
  const uint64_t summary_start = file_.size();
  crc_ = 0;
  std::string offsets;
  const auto put_group = [&](Opcode group, const std::string& records) -> Status {
    if (records.empty()) return {};
    append_summary_offset(offsets, group, file_.size(), records.size());
    return put(records);
  };
  std::string records;
  for (const auto& [id, schema] : schemas_) append(records, schema);
  ENGRAM_RETURN_IF_ERROR(put_group(Opcode::kSchema, records));
  records.clear();
  for (const auto& [id, channel] : channels_) append(records, channel);
  ENGRAM_RETURN_IF_ERROR(put_group(Opcode::kChannel, records));
  records.clear();
  append(records, statistics_);
  ENGRAM_RETURN_IF_ERROR(put_group(Opcode::kStatistics, records));
  ENGRAM_RETURN_IF_ERROR(put_group(Opcode::kMetadataIndex, metadata_index_));
  ENGRAM_RETURN_IF_ERROR(put_group(Opcode::kAttachmentIndex, attachment_index_));
  records.clear();
  for (const ChunkIndexRecord& chunk : chunks_) append(records, chunk);
  ENGRAM_RETURN_IF_ERROR(put_group(Opcode::kChunkIndex, records));
  const uint64_t offsets_start = file_.size();
  ENGRAM_RETURN_IF_ERROR(put(offsets));
  std::string footer;
  // The summary's checksum covers the footer up to the checksum itself.
  append(footer, FooterRecord{summary_start, offsets_start, 0});
  constexpr size_t kCrcBytes = sizeof(uint32_t);
  footer.resize(footer.size() - kCrcBytes);
  ENGRAM_RETURN_IF_ERROR(put(footer));
  std::string end(reinterpret_cast<const char*>(&crc_), kCrcBytes);
  return put(end + std::string(kMagic));
}

Result<uint64_t> McapWriter::close() {
  ENGRAM_RETURN_IF_ERROR(flush_chunk());
  // Channels without messages are described too, so that empty streams keep their names.
  for (const auto& [id, channel] : channels_) describe(id);
  ENGRAM_RETURN_IF_ERROR(flush_chunk());
  statistics_.schema_count = static_cast<uint16_t>(schemas_.size());
  statistics_.channel_count = static_cast<uint32_t>(channels_.size());
  statistics_.chunk_count = static_cast<uint32_t>(chunks_.size());
  std::string end;
  append_data_end(end, options_.has_data_checksum ? crc_ : 0);
  ENGRAM_RETURN_IF_ERROR(put(end));
  ENGRAM_RETURN_IF_ERROR(put_summary());
  ENGRAM_RETURN_IF_ERROR(file_.publish());
  return file_.size();
}

}  // namespace engram::datasets::mcap
