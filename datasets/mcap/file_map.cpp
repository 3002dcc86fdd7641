// SPDX-License-Identifier: Apache-2.0
#include "datasets/mcap/file_map.h"

#include <algorithm>
#include <cstring>

#include "datasets/mcap/mcap_compression.h"

namespace engram::datasets::mcap {

namespace {

constexpr uint64_t kLooseRegionBytes = 1 << 20;
constexpr uint64_t kMaxMetadataBytes = 16 << 20;
/// Enough bytes for a chunk's fields before its records, since names of compressions are short.
constexpr uint64_t kChunkStartBytes = 256;

class FileMapper {
 public:
  FileMapper(FileWindow& file, ReadingReport& report) : file_(file), report_(report) {}

  Result<FileMap> run() {
    ENGRAM_RETURN_IF_ERROR(check_magic());
    at_ = kMagic.size();
    while (true) {
      ENGRAM_ASSIGN_OR_RETURN(const bool goes_on, step());
      if (!goes_on) break;
    }
    std::ranges::stable_sort(map_.attachments, {}, &AttachmentPlace::log_time);
    if (needs_chunks()) ENGRAM_RETURN_IF_ERROR(open_chunks());
    return std::move(map_);
  }

 private:
  std::string place(uint64_t offset) const {
    return fmt::format("'{}', offset {}", file_.path().string(), offset);
  }

  Status check_magic() {
    const uint64_t count = std::min<uint64_t>(file_.size(), kMagic.size());
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes, file_.read(0, count));
    if (as_text(bytes) == kMagic) return {};
    if (file_.size() < kMagic.size())
      return data_loss("'{}': has {} bytes, needs the {} with which MCAP begins",
                       file_.path().string(), file_.size(), kMagic.size());
    return invalid_argument("'{}', offset 0: is no MCAP file of version 0", file_.path().string());
  }

  bool end_early(std::string_view needed) {
    report_.truncated_at =
        fmt::format("{}: the file ends after {} bytes, needs {}", place(at_), file_.size(), needed);
    return false;
  }

  void note(uint64_t offset, std::string_view what) {
    // A damaged file may have a million faults; the report stays readable.
    constexpr size_t kMaxNotes = 20;
    if (notes_++ < kMaxNotes)
      ++report_.not_carried[fmt::format("{}: {}", place(offset), what)];
    else
      ++report_.not_carried["further damaged records"];
  }

  /// Takes one record; returns false after the last one.
  Result<bool> step() {
    if (file_.size() - at_ < kRecordStartBytes) return end_early("a record");
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes, file_.read(at_, kRecordStartBytes));
    const RecordStart start = read_start(bytes);
    const uint64_t content = at_ + kRecordStartBytes;
    if (start.length > file_.size() - content)
      return end_early(fmt::format("a record of {} bytes", start.length));
    if (at_ == kMagic.size() && start.opcode != Opcode::kHeader)
      return data_loss("{}: record 0x{:02x}, needs a header (0x01)", place(at_),
                       static_cast<int>(start.opcode));
    if (start.opcode == Opcode::kFooter) return take_footer(content, start.length);
    ENGRAM_RETURN_IF_ERROR(take(start, content));
    at_ = content + start.length;
    return true;
  }

  Status take(const RecordStart& start, uint64_t content) {
    switch (start.opcode) {
      case Opcode::kMessage:
        return take_message(start.length, content);
      case Opcode::kChunk:
        return take_chunk(start.length, content);
      case Opcode::kMessageIndex:
        return take_message_index(start.length, content);
      case Opcode::kAttachment:
        return take_attachment(start.length, content);
      case Opcode::kChunkIndex:
      case Opcode::kAttachmentIndex:
      case Opcode::kMetadataIndex:
      case Opcode::kSummaryOffset:
        return {};
      case Opcode::kHeader:
      case Opcode::kSchema:
      case Opcode::kChannel:
      case Opcode::kStatistics:
      case Opcode::kMetadata:
      case Opcode::kDataEnd:
        break;
      default:
        ++report_.not_carried[fmt::format("records of unknown kind 0x{:02x}",
                                          static_cast<int>(start.opcode))];
        return {};
    }
    if (start.length > kMaxRecordBytes) return note(at_, "record is too large"), Status();
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes, file_.read(content, start.length));
    if (const Status status = take_small(start.opcode, bytes); !status.ok()) {
      if (status.code() != StatusCode::kDataLoss) return status;
      note(at_, status.message());
    }
    return {};
  }

  Status take_small(Opcode opcode, std::span<const std::byte> bytes) {
    if (opcode == Opcode::kHeader) {
      ENGRAM_ASSIGN_OR_RETURN(map_.header, read_header(bytes));
    } else if (opcode == Opcode::kSchema) {
      ENGRAM_ASSIGN_OR_RETURN(auto schema, read_schema(bytes));
      add(std::move(schema));
    } else if (opcode == Opcode::kChannel) {
      ENGRAM_ASSIGN_OR_RETURN(auto channel, read_channel(bytes));
      add(std::move(channel));
    } else if (opcode == Opcode::kStatistics) {
      ENGRAM_ASSIGN_OR_RETURN(map_.statistics, read_statistics(bytes));
    } else if (opcode == Opcode::kMetadata) {
      ENGRAM_ASSIGN_OR_RETURN(auto metadata, read_metadata(bytes));
      metadata_bytes_ += bytes.size();
      if (metadata_bytes_ > kMaxMetadataBytes)
        ++report_.not_carried["metadata records beyond 16 MiB"];
      else
        map_.metadata.push_back(std::move(metadata));
    } else {
      ENGRAM_ASSIGN_OR_RETURN(const uint32_t crc, read_data_end(bytes));
      if (crc != 0) return check_crc("data section", 0, at_, crc);
    }
    return {};
  }

  void add(SchemaRecord schema) {
    if (schema.id != 0) map_.schemas.try_emplace(schema.id, std::move(schema));
  }
  void add(ChannelRecord channel) { map_.channels.try_emplace(channel.id, std::move(channel)); }

  Status check_crc(std::string_view what, uint64_t begin, uint64_t end, uint32_t needed) {
    uint32_t crc = 0;
    constexpr uint64_t kBlockBytes = 1 << 20;
    for (uint64_t at = begin; at < end; at += kBlockBytes) {
      ENGRAM_ASSIGN_OR_RETURN(const auto bytes, file_.read(at, std::min(kBlockBytes, end - at)));
      crc = crc32_of(bytes, crc);
    }
    if (crc != needed)
      note(begin, fmt::format("CRC of the {} is {:08x}, the file says {:08x}", what, crc, needed));
    return {};
  }

  Result<bool> take_footer(uint64_t content, uint64_t length) {
    if (length < FooterRecord::kBytes || file_.size() - content - length < kMagic.size())
      return end_early("a footer of 20 bytes and the magic bytes");
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes, file_.read(content, length + kMagic.size()));
    if (as_text(bytes.subspan(length)).substr(0, kMagic.size()) != kMagic)
      return end_early("the magic bytes at the end");
    ENGRAM_ASSIGN_OR_RETURN(const FooterRecord footer, read_footer(bytes));
    if (footer.summary_crc != 0) {
      const uint64_t end = content + FooterRecord::kBytes - sizeof(uint32_t);
      const uint64_t begin = footer.summary_start == 0 ? at_ : footer.summary_start;
      if (begin > end)
        note(at_, fmt::format("summary at {}, needs an offset before the footer", begin));
      else
        ENGRAM_RETURN_IF_ERROR(check_crc("summary", begin, end, footer.summary_crc));
    }
    if (content + length + kMagic.size() != file_.size())
      note(content + length, "bytes follow the end of the recording");
    has_footer_ = true;
    return false;
  }

  Status take_message(uint64_t length, uint64_t content) {
    const uint64_t count = std::min(length, MessageRecord::kStartBytes);
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes, file_.read(content, count));
    const auto message = read_message(bytes);
    if (!message.ok() || length > kMaxRecordBytes) {
      ++report_.damaged;
      note(at_, message.ok() ? "message is too large" : message.status().message());
      return {};
    }
    Region* last = map_.regions.empty() ? nullptr : &map_.regions.back();
    if (last == nullptr || last->is_chunk || last->offset + last->length != at_ ||
        last->length > kLooseRegionBytes) {
      map_.regions.push_back({at_, 0, message->log_time, 0, false});
      last = &map_.regions.back();
    }
    last->start_time = std::min(last->start_time, message->log_time);
    last->length += kRecordStartBytes + length;
    ++last->messages;
    map_.first_region.try_emplace(message->channel_id, map_.regions.size() - 1);
    return {};
  }

  Status take_chunk(uint64_t length, uint64_t content) {
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes,
                            file_.read(content, std::min(length, kChunkStartBytes)));
    const auto chunk = read_chunk(bytes);
    if (!chunk.ok() || chunk->records_size != length - chunk->records_at) {
      ++report_.damaged;
      note(at_, chunk.ok() ? "chunk's records have not the size of its record"
                           : chunk.status().message());
      return {};
    }
    map_.regions.push_back({at_, kRecordStartBytes + length, chunk->start_time, 0, true});
    return {};
  }

  Status take_attachment(uint64_t length, uint64_t content) {
    uint64_t log_time = 0;
    if (length > kMaxRecordBytes || length < sizeof(log_time)) {
      ++report_.damaged;
      note(at_, "attachment is too large, or too small");
      return {};
    }
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes, file_.read(content, sizeof(log_time)));
    std::memcpy(&log_time, bytes.data(), sizeof(log_time));
    map_.attachments.push_back({content, length, log_time});
    return {};
  }

  Status take_message_index(uint64_t length, uint64_t content) {
    constexpr uint64_t kStartBytes = 6;
    constexpr uint64_t kEntryBytes = 16;
    if (length < kStartBytes || map_.regions.empty() || !map_.regions.back().is_chunk) return {};
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes, file_.read(content, kStartBytes));
    uint16_t channel = 0;
    std::memcpy(&channel, bytes.data(), sizeof(channel));
    const uint64_t messages = (length - kStartBytes) / kEntryBytes;
    if (messages == 0) return {};
    map_.regions.back().messages += messages;
    map_.first_region.try_emplace(channel, map_.regions.size() - 1);
    return {};
  }

  /// Returns true if schemas or channels may be defined only in chunks.
  [[nodiscard]] bool needs_chunks() const {
    const bool lacks_index = std::ranges::any_of(
        map_.regions, [](const Region& region) { return region.messages == 0; });
    return !has_footer_ || !map_.statistics || lacks_index ||
           map_.statistics->channel_count != map_.channels.size();
  }

  Status open_chunks() {
    for (size_t i = 0; i < map_.regions.size(); ++i) {
      if (!map_.regions[i].is_chunk) continue;
      auto loaded = load_region(file_, map_.regions[i]);
      if (!loaded.ok()) {
        if (loaded.status().code() == StatusCode::kUnavailable) return loaded.status();
        continue;  // The problem is reported when the region is read.
      }
      for (SchemaRecord& schema : loaded->schemas) add(std::move(schema));
      for (ChannelRecord& channel : loaded->channels) add(std::move(channel));
      for (const auto& entry : loaded->entries)
        map_.first_region.try_emplace(message_at(*loaded, entry).channel_id, i);
      map_.regions[i].messages = loaded->entries.size();
    }
    return {};
  }

  FileWindow& file_;
  ReadingReport& report_;
  FileMap map_;
  uint64_t at_ = 0;
  uint64_t metadata_bytes_ = 0;
  size_t notes_ = 0;
  bool has_footer_ = false;
};

/// Finds the records inside of a region.
Status list_records(LoadedRegion& loaded) {
  const auto bytes = loaded.bytes.bytes();
  for (uint64_t at = 0; at < bytes.size();) {
    if (bytes.size() - at < kRecordStartBytes)
      return data_loss("record {} bytes into the chunk's {}: needs {} to begin", at, bytes.size(),
                       kRecordStartBytes);
    const RecordStart start = read_start(bytes.subspan(at, kRecordStartBytes));
    const uint64_t left = bytes.size() - at - kRecordStartBytes;
    if (start.length > left)
      return data_loss("record {} bytes into the chunk: needs {} bytes, {} are left", at,
                       start.length, left);
    const auto content = bytes.subspan(at + kRecordStartBytes, start.length);
    if (start.opcode == Opcode::kMessage) {
      ENGRAM_ASSIGN_OR_RETURN(const MessageRecord message, read_message(content));
      loaded.entries.push_back({message.log_time, at});
    } else if (start.opcode == Opcode::kSchema) {
      ENGRAM_ASSIGN_OR_RETURN(auto schema, read_schema(content));
      loaded.schemas.push_back(std::move(schema));
    } else if (start.opcode == Opcode::kChannel) {
      ENGRAM_ASSIGN_OR_RETURN(auto channel, read_channel(content));
      loaded.channels.push_back(std::move(channel));
    }
    at += kRecordStartBytes + start.length;
  }
  return {};
}

Result<Buffer> region_bytes(FileWindow& file, const Region& region) {
  if (region.length > kMaxRecordBytes + kChunkStartBytes)
    return data_loss("has {} bytes, needs at most {}", region.length, kMaxRecordBytes);
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes, file.read(region.offset, region.length));
  if (!region.is_chunk) return Buffer::copy(bytes);
  const auto content = bytes.subspan(kRecordStartBytes);
  ENGRAM_ASSIGN_OR_RETURN(const ChunkRecord chunk, read_chunk(content));
  ENGRAM_ASSIGN_OR_RETURN(
      Buffer plain,
      decompress(chunk.compression, content.subspan(chunk.records_at, chunk.records_size),
                 chunk.uncompressed_size));
  const uint32_t crc = chunk.uncompressed_crc == 0 ? 0 : crc32_of(plain.bytes());
  if (crc != chunk.uncompressed_crc)
    return data_loss("CRC of the chunk is {:08x}, the file says {:08x}", crc,
                     chunk.uncompressed_crc);
  return plain;
}

}  // namespace

Result<LoadedRegion> load_region(FileWindow& file, const Region& region) {
  const auto place = [&](const Status& status) {
    return status.with_context(fmt::format("'{}', offset {}", file.path().string(), region.offset));
  };
  LoadedRegion loaded;
  auto bytes = region_bytes(file, region);
  if (!bytes.ok()) return place(bytes.status());
  loaded.bytes = *std::move(bytes);
  if (const Status status = list_records(loaded); !status.ok()) return place(status);
  return loaded;
}

MessageRecord message_at(std::span<const std::byte> bytes) {
  const RecordStart start = read_start(bytes.first(kRecordStartBytes));
  return read_message(bytes.subspan(kRecordStartBytes, start.length)).value();
}

Result<FileMap> map_file(FileWindow& file, ReadingReport& report) {
  return FileMapper(file, report).run();
}

}  // namespace engram::datasets::mcap
