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
/// Size of each length: in front of a header, of its fields and of the data.
inline constexpr uint64_t kLengthBytes = 4;
/// The maximum size of a chunk or message that is accepted. Unit: bytes.
inline constexpr uint64_t kMaxRecordBytes = uint64_t{512} << 20;
/// Times in bags must be before this. Unit: ns since 1970.
inline constexpr uint64_t kEndOfTime = (uint64_t{1} << 32) * 1'000'000'000;
/// The maximum size of a record's header that is accepted. Unit: bytes.
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

/// The "name=value" fields in headers of records and in the data of connections. It refers to the
/// bytes that it was parsed from. If several names are equal, the first one is used.
class Header {
 public:
  /// Errors: kDataLoss naming the offset in `bytes`, what was found and what was needed.
  static Result<Header> parse(std::span<const std::byte> bytes);

  [[nodiscard]] std::optional<std::string_view> find(std::string_view name) const;

  /// Errors, also of the functions below: kDataLoss naming the field if it is missing or has
  /// another size.
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

/// The header and data of one record. It refers to the bytes that it was read from.
struct Record {
  Header header;
  std::span<const std::byte> data;
  uint64_t size = 0;  ///< Size of the whole record. Unit: bytes.
};

/// Reads the record at the start of `bytes`.
/// Errors: kDataLoss saying what was found and what was needed.
Result<Record> read_record(std::span<const std::byte> bytes);

/// Reads a little-endian number. `bytes` must have at least four bytes (checked).
[[nodiscard]] uint32_t read_u32(std::span<const std::byte> bytes);

struct Connection {
  uint32_t id = 0;
  std::string topic;
  std::string type;        ///< "sensor_msgs/Image".
  std::string md5sum;      ///< The MD5 sum of the definition.
  std::string definition;  ///< The text of the definition.
  Fields others;           ///< Further fields of the header: topic, callerid, latching, ...

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
  uint64_t index_pos = 0;  ///< Offset of the connections after the last chunk; 0 if not closed.
  uint32_t connections = 0;
  uint32_t chunks = 0;
};

/// The place of a message in its chunk.
struct IndexEntry {
  uint64_t time = 0;    ///< Unit: ns since 1970.
  uint32_t offset = 0;  ///< Offset of its record in the uncompressed chunk.
};

struct ChunkInfo {
  uint64_t offset = 0;  ///< Offset of the chunk's record in the file.
  uint64_t start_time = 0;
  uint64_t end_time = 0;
  std::map<uint32_t, uint32_t> messages;  ///< Number of messages of each connection in the chunk.
};

// Each function appends a whole record. Times must be before 2106, where 32 bits of seconds end,
// and data must have fewer than 2^32 bytes (both checked).
/// The record is padded, so that its size does not depend on its contents.
void append(std::string& out, const BagHeader& header);
void append(std::string& out, const Connection& connection);
void append(std::string& out, const Message& message);
void append(std::string& out, const ChunkInfo& info);
/// `packed` is the compressed form of records of `plain_bytes` bytes.
void append_chunk(std::string& out, std::string_view compression, uint64_t plain_bytes,
                  std::string_view packed);
/// Appends the index of one connection's messages in the chunk before it.
void append_index(std::string& out, uint32_t connection, const std::vector<IndexEntry>& entries);

}  // namespace engram::datasets::rosbag
