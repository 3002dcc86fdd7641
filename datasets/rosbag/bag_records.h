// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ltm/core/status.h"

namespace engram::datasets::rosbag {

inline constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
/// Of each length in front of a header, its fields and the data behind it.
inline constexpr uint64_t kLengthBytes = 4;
/// More in one chunk or message is refused. Unit: bytes.
inline constexpr uint64_t kMaxRecordBytes = uint64_t{512} << 20;
/// Times of bags are before this. Unit: ns since 1970.
inline constexpr uint64_t kEndOfTime = (uint64_t{1} << 32) * 1'000'000'000;
/// More in one record's header is refused. Unit: bytes.
inline constexpr uint64_t kMaxHeaderBytes = uint64_t{1} << 20;

enum class Opcode : uint8_t {
  kMessage = 0x02,
  kBagHeader = 0x03,
  kIndex = 0x04,
  kChunk = 0x05,
  kChunkInfo = 0x06,
  kConnection = 0x07,
};

using Fields = std::vector<std::pair<std::string, std::string>>;

/// "name=value" fields, as headers of records and the data of connections are. Views the bytes that
/// it was made of; of equal names the first counts.
class Header {
 public:
  /// Errors: kDataLoss naming the offset in `bytes`, what was found and what was needed.
  static Result<Header> parse(std::span<const std::byte> bytes);

  [[nodiscard]] std::optional<std::string_view> find(std::string_view name) const;

  /// Errors: kDataLoss naming the field where it is missing or has another size; here and below.
  template <typename T>
  Result<T> number(std::string_view name) const {
    const auto value = find(name);
    if (!value || value->size() != sizeof(T))
      return data_loss("field '{}' has {} bytes, needs {}", name, value ? value->size() : 0,
                       sizeof(T));
    T number;
    std::memcpy(&number, value->data(), sizeof(T));
    return number;
  }
  Result<std::string_view> text(std::string_view name) const;
  Result<Opcode> opcode() const;
  /// Unit: ns since 1970.
  Result<uint64_t> time(std::string_view name) const;

  [[nodiscard]] const std::vector<std::pair<std::string_view, std::string_view>>& fields() const {
    return fields_;
  }

 private:
  std::vector<std::pair<std::string_view, std::string_view>> fields_;
};

/// Header and data of one record. Views what it was read of.
struct Record {
  Header header;
  std::span<const std::byte> data;
  uint64_t size = 0;  ///< Of all of it. Unit: bytes.
};

/// The record at the start of `bytes`.
/// Errors: kDataLoss saying what was found and what was needed.
Result<Record> read_record(std::span<const std::byte> bytes);

/// Little-endian; of at least four bytes (checked).
[[nodiscard]] uint32_t read_u32(std::span<const std::byte> bytes);

struct Connection {
  uint32_t id = 0;
  std::string topic;
  std::string type;        ///< "sensor_msgs/Image".
  std::string md5sum;      ///< Of the definition.
  std::string definition;  ///< Text.
  Fields others;           ///< Of the connection's header: topic, callerid, latching, ...

  [[nodiscard]] const std::string* find(std::string_view name) const;
  friend bool operator==(const Connection&, const Connection&) = default;
};

/// Errors: kDataLoss naming the field.
Result<Connection> read_connection(const Record& record);

struct Message {
  uint32_t connection = 0;
  uint64_t time = 0;  ///< Unit: ns since 1970.
  std::span<const std::byte> data;
};

/// Errors: kDataLoss naming the field.
Result<Message> read_message(const Record& record);

/// The first record of a bag.
struct BagHeader {
  uint64_t index_pos = 0;  ///< Offset of the connections behind the last chunk; 0: not closed.
  uint32_t connections = 0;
  uint32_t chunks = 0;
};

/// Where a message lies in its chunk.
struct IndexEntry {
  uint64_t time = 0;    ///< Unit: ns since 1970.
  uint32_t offset = 0;  ///< Of its record among the plain ones of the chunk.
};

struct ChunkInfo {
  uint64_t offset = 0;  ///< Of the chunk's record in the file.
  uint64_t start_time = 0;
  uint64_t end_time = 0;
  std::map<uint32_t, uint32_t> messages;  ///< Of each connection that has some in it.
};

// Each appends a whole record. Times are before 2106, where their seconds end, and data have fewer
// than 2^32 bytes (both checked).
/// Padded: it has the same size whatever it says.
void append(std::string& out, const BagHeader& header);
void append(std::string& out, const Connection& connection);
void append(std::string& out, const Message& message);
void append(std::string& out, const ChunkInfo& info);
/// `packed` are records of `plain_bytes` bytes, compressed.
void append_chunk(std::string& out, std::string_view compression, uint64_t plain_bytes,
                  std::string_view packed);
/// Of one connection's messages in the chunk before it.
void append_index(std::string& out, uint32_t connection, const std::vector<IndexEntry>& entries);

}  // namespace engram::datasets::rosbag
