// SPDX-License-Identifier: Apache-2.0
#include "datasets/rosbag/bag_records.h"

#include <algorithm>
#include <array>
#include <limits>

#include "ltm/core/buffer.h"
#include "ltm/core/check.h"

namespace engram::datasets::rosbag {

namespace {

constexpr uint64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr uint32_t kVersion = 1;

void put_length(std::string& out, size_t length) {
  ENGRAM_CHECK(length <= std::numeric_limits<uint32_t>::max(), "{} bytes", length);
  const auto value = static_cast<uint32_t>(length);
  out.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

void put_field(std::string& out, std::string_view name, std::string_view value) {
  put_length(out, name.size() + 1 + value.size());
  out.append(name).append("=").append(value);
}

template <typename T>
std::string number_text(T value) {
  return std::string(reinterpret_cast<const char*>(&value), sizeof(value));
}

std::string time_text(uint64_t ns) {
  ENGRAM_CHECK(ns < kEndOfTime, "{} ns", ns);
  return number_text(static_cast<uint32_t>(ns / kNanosecondsPerSecond)) +
         number_text(static_cast<uint32_t>(ns % kNanosecondsPerSecond));
}

/// Appends everything of a record except its data.
void put_header(std::string& out, Opcode opcode, const Fields& fields, size_t data_bytes) {
  std::string header;
  put_field(header, "op", number_text(opcode));
  for (const auto& [name, value] : fields) put_field(header, name, value);
  put_length(out, header.size());
  out += header;
  put_length(out, data_bytes);
}

}  // namespace

uint32_t read_u32(std::span<const std::byte> bytes) {
  ENGRAM_CHECK(bytes.size() >= kLengthBytes, "{} bytes", bytes.size());
  uint32_t value = 0;
  std::memcpy(&value, bytes.data(), sizeof(value));
  return value;
}

Result<Header> Header::parse(std::span<const std::byte> bytes) {
  Header header;
  for (uint64_t at = 0; at < bytes.size();) {
    const uint64_t left = bytes.size() - at;
    if (left < kLengthBytes)
      return data_loss("header, byte {}: {} are left, needs {} of a field's length", at, left,
                       kLengthBytes);
    const uint64_t length = read_u32(bytes.subspan(at));
    if (length > left - kLengthBytes)
      return data_loss("header, byte {}: field needs {} bytes, {} are left", at, length,
                       left - kLengthBytes);
    const auto text = as_text(bytes.subspan(at + kLengthBytes, length));
    const size_t equals = text.find('=');
    if (equals == std::string_view::npos)
      return data_loss("header, byte {}: field has no '=' behind its name", at);
    header.fields_.emplace_back(text.substr(0, equals), text.substr(equals + 1));
    at += kLengthBytes + length;
  }
  return header;
}

std::optional<std::string_view> Header::find(std::string_view name) const {
  for (const auto& [key, value] : fields_)
    if (key == name) return value;
  return std::nullopt;
}

Result<std::string_view> Header::text(std::string_view name) const {
  const auto value = find(name);
  if (!value) return data_loss("needs the field '{}'", name);
  return *value;
}

Result<Opcode> Header::opcode() const {
  ENGRAM_ASSIGN_OR_RETURN(const auto opcode, number<uint8_t>("op"));
  return static_cast<Opcode>(opcode);
}

Result<uint64_t> Header::time(std::string_view name) const {
  ENGRAM_ASSIGN_OR_RETURN(const auto value, (number<std::array<uint32_t, 2>>(name)));
  return value[0] * kNanosecondsPerSecond + value[1];
}

Result<Record> read_record(std::span<const std::byte> bytes) {
  if (bytes.size() < kLengthBytes)
    return data_loss("{} bytes are left, needs {} of a header's length", bytes.size(),
                     kLengthBytes);
  const uint64_t header_bytes = read_u32(bytes);
  // The lengths are compared in 64 bits, so hostile ones cannot overflow.
  if (header_bytes + 2 * kLengthBytes > bytes.size())
    return data_loss("header of {} bytes and a length: {} are left", header_bytes,
                     bytes.size() - kLengthBytes);
  Record record;
  ENGRAM_ASSIGN_OR_RETURN(record.header, Header::parse(bytes.subspan(kLengthBytes, header_bytes)));
  const auto rest = bytes.subspan(kLengthBytes + header_bytes);
  const uint64_t data_bytes = read_u32(rest);
  if (data_bytes > rest.size() - kLengthBytes)
    return data_loss("data of {} bytes: {} are left", data_bytes, rest.size() - kLengthBytes);
  record.data = rest.subspan(kLengthBytes, data_bytes);
  record.size = 2 * kLengthBytes + header_bytes + data_bytes;
  return record;
}

const std::string* Connection::find(std::string_view name) const {
  const auto found = std::ranges::find(others, name, &Fields::value_type::first);
  return found == others.end() ? nullptr : &found->second;
}

Result<Connection> read_connection(const Record& record) {
  Connection connection;
  ENGRAM_ASSIGN_OR_RETURN(connection.id, record.header.number<uint32_t>("conn"));
  ENGRAM_ASSIGN_OR_RETURN(connection.topic, record.header.text("topic"));
  ENGRAM_ASSIGN_OR_RETURN(const Header about, Header::parse(record.data));
  ENGRAM_ASSIGN_OR_RETURN(connection.type, about.text("type"));
  ENGRAM_ASSIGN_OR_RETURN(connection.md5sum, about.text("md5sum"));
  ENGRAM_ASSIGN_OR_RETURN(connection.definition, about.text("message_definition"));
  for (const auto& [name, value] : about.fields())
    if (name != "type" && name != "md5sum" && name != "message_definition" &&
        connection.find(name) == nullptr)
      connection.others.emplace_back(name, value);
  return connection;
}

Result<Message> read_message(const Record& record) {
  Message message{0, 0, record.data};
  ENGRAM_ASSIGN_OR_RETURN(message.connection, record.header.number<uint32_t>("conn"));
  ENGRAM_ASSIGN_OR_RETURN(message.time, record.header.time("time"));
  return message;
}

void append(std::string& out, const BagHeader& header) {
  // Size of the header and the data together.
  constexpr size_t kPaddedBytes = 4096;
  const Fields fields{{"index_pos", number_text(header.index_pos)},
                      {"conn_count", number_text(header.connections)},
                      {"chunk_count", number_text(header.chunks)}};
  std::string plain;
  put_header(plain, Opcode::kBagHeader, fields, 0);
  const size_t padding = kPaddedBytes - (plain.size() - 2 * kLengthBytes);
  put_header(out, Opcode::kBagHeader, fields, padding);
  out.append(padding, ' ');
}

void append(std::string& out, const Connection& connection) {
  std::string about;
  put_field(about, "type", connection.type);
  put_field(about, "md5sum", connection.md5sum);
  put_field(about, "message_definition", connection.definition);
  for (const auto& [name, value] : connection.others) put_field(about, name, value);
  put_header(out, Opcode::kConnection,
             {{"conn", number_text(connection.id)}, {"topic", connection.topic}}, about.size());
  out += about;
}

void append(std::string& out, const Message& message) {
  put_header(out, Opcode::kMessage,
             {{"conn", number_text(message.connection)}, {"time", time_text(message.time)}},
             message.data.size());
  out += as_text(message.data);
}

void append(std::string& out, const ChunkInfo& info) {
  std::string counts;
  for (const auto& [connection, messages] : info.messages)
    counts += number_text(connection) + number_text(messages);
  put_header(out, Opcode::kChunkInfo,
             {{"ver", number_text(kVersion)},
              {"chunk_pos", number_text(info.offset)},
              {"start_time", time_text(info.start_time)},
              {"end_time", time_text(info.end_time)},
              {"count", number_text(static_cast<uint32_t>(info.messages.size()))}},
             counts.size());
  out += counts;
}

void append_chunk(std::string& out, std::string_view compression, uint64_t plain_bytes,
                  std::string_view packed) {
  put_header(out, Opcode::kChunk,
             {{"compression", std::string(compression)},
              {"size", number_text(static_cast<uint32_t>(plain_bytes))}},
             packed.size());
  out += packed;
}

void append_index(std::string& out, uint32_t connection, const std::vector<IndexEntry>& entries) {
  std::string data;
  for (const IndexEntry& entry : entries) data += time_text(entry.time) + number_text(entry.offset);
  put_header(out, Opcode::kIndex,
             {{"ver", number_text(kVersion)},
              {"conn", number_text(connection)},
              {"count", number_text(static_cast<uint32_t>(entries.size()))}},
             data.size());
  out += data;
}

}  // namespace engram::datasets::rosbag
