// SPDX-License-Identifier: Apache-2.0
#include "datasets/rosbag/bag_map.h"

#include <algorithm>
#include <limits>

#include "datasets/rosbag/bag_compression.h"

namespace engram::datasets::rosbag {

namespace {

constexpr uint64_t kLooseRegionBytes = 1 << 20;
constexpr uint64_t kNoTime = std::numeric_limits<uint64_t>::max();
constexpr uint32_t kIndexVersion = 1;

std::string place(const FileWindow& file, uint64_t offset) {
  return fmt::format("'{}', offset {}", file.path().string(), offset);
}

/// The places of the parts of a record in the file.
struct RecordPlace {
  uint64_t offset;
  uint64_t header_bytes;
  uint64_t data_bytes;

  [[nodiscard]] uint64_t header_at() const { return offset + kLengthBytes; }
  [[nodiscard]] uint64_t data_at() const { return header_at() + header_bytes + kLengthBytes; }
  [[nodiscard]] uint64_t end() const { return data_at() + data_bytes; }
};

class BagMapper {
 public:
  BagMapper(FileWindow& file, ReadingReport& report) : file_(file), report_(report) {}

  Result<BagMap> run() {
    ENGRAM_RETURN_IF_ERROR(check_magic());
    at_ = kMagic.size();
    ENGRAM_RETURN_IF_ERROR(take_bag_header());
    while (at_ < file_.size()) {
      ENGRAM_ASSIGN_OR_RETURN(const auto record, next_record());
      if (!record) break;
      ENGRAM_RETURN_IF_ERROR(take(*record));
      at_ = record->end();
    }
    check_end();
    if (needs_chunks_) ENGRAM_RETURN_IF_ERROR(open_chunks());
    return std::move(map_);
  }

 private:
  Status check_magic() {
    const uint64_t count = std::min<uint64_t>(file_.size(), kMagic.size());
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes, file_.read(0, count));
    const std::string_view text = as_text(bytes);
    if (text == kMagic) return {};
    constexpr std::string_view kAnyVersion = "#ROSBAG V";
    if (file_.size() < kMagic.size())
      return data_loss("'{}': has {} bytes, needs the {} with which a bag begins",
                       file_.path().string(), file_.size(), kMagic.size());
    if (text.starts_with(kAnyVersion))
      return invalid_argument("{}: is a bag of another version, needs 2.0 (`rosbag fix`)",
                              place(file_, 0));
    return invalid_argument("{}: is no bag of ROS 1", place(file_, 0));
  }

  void end_early(std::string_view needed) {
    needs_chunks_ = true;
    if (report_.truncated_at.empty())
      report_.truncated_at = fmt::format("{}: the file ends after {} bytes, needs {}",
                                         place(file_, at_), file_.size(), needed);
  }

  void note(uint64_t offset, std::string_view what) {
    // A damaged file may have a million faults; the report stays readable.
    constexpr size_t kMaxNotes = 20;
    if (notes_++ < kMaxNotes)
      ++report_.not_carried[fmt::format("{}: {}", place(file_, offset), what)];
    else
      ++report_.not_carried["further damaged records"];
  }

  /// Reads the lengths of the record at at_; returns nothing if the file ends before the record.
  Result<std::optional<RecordPlace>> next_record() {
    RecordPlace record{at_, 0, 0};
    const uint64_t left = file_.size() - at_;
    if (left < kLengthBytes) return end_early("a record"), std::optional<RecordPlace>();
    ENGRAM_ASSIGN_OR_RETURN(const auto length, file_.read(at_, kLengthBytes));
    record.header_bytes = read_u32(length);
    if (record.header_bytes > kMaxHeaderBytes || record.header_bytes + 2 * kLengthBytes > left)
      return end_early(fmt::format("a header of {} bytes (at most {}), and a length",
                                   record.header_bytes, kMaxHeaderBytes)),
             std::optional<RecordPlace>();
    ENGRAM_ASSIGN_OR_RETURN(const auto data,
                            file_.read(record.data_at() - kLengthBytes, kLengthBytes));
    record.data_bytes = read_u32(data);
    if (record.data_bytes > file_.size() - record.data_at())
      return end_early(fmt::format("data of {} bytes", record.data_bytes)),
             std::optional<RecordPlace>();
    return std::optional(record);
  }

  /// The result refers to the window of the file.
  Result<Record> read(const RecordPlace& record) {
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes,
                            file_.read(record.offset, record.end() - record.offset));
    return read_record(bytes);
  }

  Status take_bag_header() {
    const std::string needed = fmt::format("{}: needs a bag header", place(file_, at_));
    ENGRAM_ASSIGN_OR_RETURN(const auto found, next_record());
    if (!found || found->data_bytes > kMaxRecordBytes)
      return data_loss("{}; the file has {} bytes", needed, file_.size());
    const auto take = [&]() -> Status {
      ENGRAM_ASSIGN_OR_RETURN(const Record record, read(*found));
      ENGRAM_ASSIGN_OR_RETURN(const Opcode opcode, record.header.opcode());
      if (opcode != Opcode::kBagHeader)
        return data_loss("found a record 0x{:02x}", static_cast<int>(opcode));
      ENGRAM_ASSIGN_OR_RETURN(index_pos_, record.header.number<uint64_t>("index_pos"));
      ENGRAM_ASSIGN_OR_RETURN(connection_count_, record.header.number<uint32_t>("conn_count"));
      ENGRAM_ASSIGN_OR_RETURN(chunk_count_, record.header.number<uint32_t>("chunk_count"));
      const auto encryptor = record.header.find("encryptor");
      if (encryptor && !encryptor->empty() && *encryptor != "rosbag/NoEncryptor")
        return invalid_argument("the bag is encrypted, needs one that is not");
      return {};
    };
    if (const Status status = take(); !status.ok()) return status.with_context(needed);
    at_ = found->end();
    return {};
  }

  /// A problem inside of a record is reported, and the record is skipped.
  Status take(const RecordPlace& found) {
    Status status = take_known(found);
    if (status.code() != StatusCode::kDataLoss) return status;
    needs_chunks_ = true;
    ++report_.damaged;
    note(found.offset, status.message());
    return {};
  }

  Status take_known(const RecordPlace& found) {
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes, file_.read(found.header_at(), found.header_bytes));
    ENGRAM_ASSIGN_OR_RETURN(const Header header, Header::parse(bytes));
    ENGRAM_ASSIGN_OR_RETURN(const Opcode opcode, header.opcode());
    switch (opcode) {
      case Opcode::kMessage:
        return take_message(found, header);
      case Opcode::kChunk:
        return take_chunk(found, header);
      case Opcode::kIndex:
        return take_index(found, header);
      case Opcode::kChunkInfo:
        ++chunk_infos_;
        return take_chunk_info(header);
      case Opcode::kConnection: {
        if (found.data_bytes > kMaxRecordBytes) return data_loss("connection is too large");
        ENGRAM_ASSIGN_OR_RETURN(const Record record, read(found));
        ENGRAM_ASSIGN_OR_RETURN(Connection connection, read_connection(record));
        add(std::move(connection), found.offset);
        return {};
      }
      default:
        ++report_.not_carried[fmt::format("records of unknown kind 0x{:02x}",
                                          static_cast<int>(opcode))];
        return {};
    }
  }

  void add(Connection connection, uint64_t offset) {
    const auto [known, is_new] = map_.connections.try_emplace(connection.id, connection);
    if (!is_new && known->second != connection)
      note(offset, fmt::format("connection {} of '{}' is described twice, not in the same way",
                               connection.id, connection.topic));
  }

  /// Takes a message outside of chunks. A recorder that was killed leaves those of its last chunk.
  Status take_message(const RecordPlace& found, const Header& header) {
    ENGRAM_ASSIGN_OR_RETURN(const Message message, read_message({header, {}, 0}));
    if (found.data_bytes > kMaxRecordBytes) return data_loss("message is too large");
    Region* last = map_.regions.empty() ? nullptr : &map_.regions.back();
    if (last == nullptr || last->is_chunk || last->offset + last->length != found.offset ||
        last->length > kLooseRegionBytes) {
      map_.regions.push_back({found.offset, 0, message.time, 0, false});
      last = &map_.regions.back();
    }
    last->start_time = std::min(last->start_time, message.time);
    last->length = found.end() - last->offset;
    ++last->messages;
    count(message.connection, 1, map_.regions.size() - 1);
    return {};
  }

  Status take_chunk(const RecordPlace& found, const Header& header) {
    ENGRAM_ASSIGN_OR_RETURN(const auto size, header.number<uint32_t>("size"));
    if (found.data_bytes == 0 && size == 0) return {};  // The chunk was begun and never finished.
    ++chunks_;
    map_.regions.push_back({found.offset, found.end() - found.offset, kNoTime, 0, true});
    return {};
  }

  /// Takes the index of the chunk before it.
  Status take_index(const RecordPlace& found, const Header& header) {
    constexpr uint64_t kEntryBytes = 12;
    constexpr uint64_t kMaxAtOnce = 4096;
    ENGRAM_ASSIGN_OR_RETURN(const auto version, header.number<uint32_t>("ver"));
    ENGRAM_ASSIGN_OR_RETURN(const auto connection, header.number<uint32_t>("conn"));
    ENGRAM_ASSIGN_OR_RETURN(const auto messages, header.number<uint32_t>("count"));
    if (version != kIndexVersion)
      return data_loss("index of version {}, needs {}", version, kIndexVersion);
    if (found.data_bytes != messages * kEntryBytes)
      return data_loss("index of {} messages has {} bytes, needs {}", messages, found.data_bytes,
                       messages * kEntryBytes);
    if (map_.regions.empty() || !map_.regions.back().is_chunk)
      return data_loss("index without a chunk before it");
    Region& chunk = map_.regions.back();
    for (uint64_t at = found.data_at(); at < found.end();) {
      const uint64_t bytes = std::min(found.end() - at, kMaxAtOnce * kEntryBytes);
      ENGRAM_ASSIGN_OR_RETURN(const auto entries, file_.read(at, bytes));
      for (uint64_t i = 0; i < bytes; i += kEntryBytes) {
        const uint64_t seconds = read_u32(entries.subspan(i));
        const uint64_t time =
            seconds * 1'000'000'000 + read_u32(entries.subspan(i + sizeof(uint32_t)));
        chunk.start_time = std::min(chunk.start_time, time);
      }
      at += bytes;
    }
    chunk.messages += messages;
    if (messages > 0) count(connection, messages, map_.regions.size() - 1);
    return {};
  }

  static Status take_chunk_info(const Header& header) {
    ENGRAM_ASSIGN_OR_RETURN(const auto version, header.number<uint32_t>("ver"));
    if (version == kIndexVersion) return {};
    return data_loss("chunk info of version {}, needs {}", version, kIndexVersion);
  }

  void count(uint32_t connection, uint64_t messages, size_t region) {
    map_.messages[connection] += messages;
    map_.first_region.try_emplace(connection, region);
  }

  void check_end() {
    const bool lacks_index = std::ranges::any_of(
        map_.regions, [](const Region& region) { return region.messages == 0; });
    needs_chunks_ = needs_chunks_ || lacks_index || map_.connections.size() != connection_count_;
    if (index_pos_ == 0)
      end_early("an index: its recorder was not closed");
    else if (chunks_ != chunk_count_ || chunk_infos_ != chunk_count_)
      end_early(fmt::format("{} chunks and as many infos of them, has {} and {}", chunk_count_,
                            chunks_, chunk_infos_));
    else if (map_.connections.size() != connection_count_)
      end_early(fmt::format("{} connections, has {}", connection_count_, map_.connections.size()));
  }

  Status open_chunks() {
    for (size_t i = 0; i < map_.regions.size(); ++i) {
      Region& region = map_.regions[i];
      if (!region.is_chunk) continue;
      std::string problem;  // It is reported when the region is read.
      auto loaded = load_region(file_, region, problem);
      if (!loaded.ok()) {
        if (loaded.status().code() == StatusCode::kUnavailable) return loaded.status();
        continue;
      }
      for (Connection& connection : loaded->connections) add(std::move(connection), region.offset);
      const bool has_index = region.messages != 0;
      region.messages = loaded->entries.size();
      for (const auto& entry : loaded->entries) {
        region.start_time = std::min(region.start_time, entry.time);
        const auto message = message_at(loaded->bytes.bytes().subspan(entry.offset));
        count(message.connection, has_index ? 0 : 1, i);
      }
    }
    return {};
  }

  FileWindow& file_;
  ReadingReport& report_;
  BagMap map_;
  uint64_t at_ = 0;
  uint64_t index_pos_ = 0;
  uint64_t connection_count_ = 0;
  uint64_t chunk_count_ = 0;
  uint64_t chunks_ = 0;
  uint64_t chunk_infos_ = 0;
  size_t notes_ = 0;
  bool needs_chunks_ = false;
};

/// Returns the records of a chunk, decompressed, or those outside of chunks.
Result<Buffer> region_bytes(std::span<const std::byte> bytes, const Region& region) {
  if (!region.is_chunk) return Buffer::copy(bytes);
  ENGRAM_ASSIGN_OR_RETURN(const Record chunk, read_record(bytes));
  ENGRAM_ASSIGN_OR_RETURN(const auto compression, chunk.header.text("compression"));
  ENGRAM_ASSIGN_OR_RETURN(const auto size, chunk.header.number<uint32_t>("size"));
  return decompress(compression, chunk.data, size);
}

/// Finds the records inside of a region.
Status list_records(LoadedRegion& loaded) {
  const auto bytes = loaded.bytes.bytes();
  for (uint64_t at = 0; at < bytes.size();) {
    const auto take = [&]() -> Status {
      ENGRAM_ASSIGN_OR_RETURN(const Record record, read_record(bytes.subspan(at)));
      ENGRAM_ASSIGN_OR_RETURN(const Opcode opcode, record.header.opcode());
      if (opcode == Opcode::kMessage) {
        ENGRAM_ASSIGN_OR_RETURN(const Message message, read_message(record));
        loaded.entries.push_back({message.time, at});
      } else if (opcode == Opcode::kConnection) {
        ENGRAM_ASSIGN_OR_RETURN(auto connection, read_connection(record));
        loaded.connections.push_back(std::move(connection));
      }
      at += record.size;
      return {};
    };
    if (const Status status = take(); !status.ok())
      return status.with_context(fmt::format("record {} bytes into the chunk", at));
  }
  return {};
}

}  // namespace

Result<LoadedRegion> load_region(FileWindow& file, const Region& region, std::string& problem) {
  const auto fail = [&](const Status& status) {
    return status.with_context(place(file, region.offset));
  };
  constexpr uint64_t kMax = kMaxRecordBytes + kMaxHeaderBytes;
  if (region.length > kMax)
    return fail(data_loss("chunk of {} bytes, needs at most {}", region.length, kMax));
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes, file.read(region.offset, region.length));
  LoadedRegion loaded;
  auto plain = region_bytes(bytes, region);
  if (!plain.ok()) return fail(plain.status());
  loaded.bytes = *std::move(plain);
  if (const Status status = list_records(loaded); !status.ok()) problem = fail(status).message();
  return loaded;
}

Message message_at(std::span<const std::byte> bytes) {
  return read_message(read_record(bytes).value()).value();
}

Result<BagMap> map_bag(FileWindow& file, ReadingReport& report) {
  return BagMapper(file, report).run();
}

}  // namespace engram::datasets::rosbag
