// SPDX-License-Identifier: Apache-2.0
#include "datasets/rosbag/records.h"

#include <algorithm>
#include <array>

#include "ltm/core/buffer.h"
#include "ltm/core/check.h"

namespace engram::datasets::rosbag {

namespace {

constexpr uint64_t kNanosecondsPerSecond = 1'000'000'000;

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

}  // namespace engram::datasets::rosbag
