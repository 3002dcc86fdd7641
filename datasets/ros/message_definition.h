// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/status.h"

namespace engram::datasets::ros {

/// How messages are serialised.
enum class Serialization : uint8_t {
  kRos1,  ///< Packed, little-endian.
  kCdr,   ///< ROS 2: XCDR1 after four bytes that give the byte order; numbers are aligned.
};

/// The type of a field, or of one element of it.
enum class FieldKind : uint8_t {
  kBool,
  kInt8,
  kUInt8,
  kInt16,
  kUInt16,
  kInt32,
  kUInt32,
  kInt64,
  kUInt64,
  kFloat32,
  kFloat64,
  kString,
  kTime,      ///< ROS 1: seconds and nanoseconds, uint32.
  kDuration,  ///< ROS 1: seconds and nanoseconds, int32.
  kMessage,
};

/// Unit: bytes. Zero for kinds that are not plain numbers.
[[nodiscard]] size_t size_bytes(FieldKind kind);

enum class Multiplicity : uint8_t { kOne, kFixed, kSequence };

struct Field {
  std::string name;
  FieldKind kind = FieldKind::kBool;
  size_t message = 0;  ///< Index of the message type; only for kMessage.
  Multiplicity multiplicity = Multiplicity::kOne;
  uint32_t count = 0;  ///< Number of elements of a fixed array.
};

struct Message {
  std::string name;  ///< "sensor_msgs/Image".
  std::vector<Field> fields;
};

/// The structure of the messages of one type: its fields, and those of all nested messages.
///
/// Constants, defaults, bounds and comments are ignored. Messages may be nested 32 deep.
/// Threading: immutable.
/// Source: docs/formats.md, "ROS messages".
class MessageDefinition {
 public:
  /// Parses the text that bags and MCAP files contain: the definition of `type`, then those that it
  /// needs, each after a line of '=' and one of "MSG: package/Type". `type` is "sensor_msgs/Image"
  /// or "sensor_msgs/msg/Image".
  /// Errors: kInvalidArgument naming type, line, what was found and what was needed; also for
  /// wstring, whose bytes differ between implementations of ROS 2.
  static Result<MessageDefinition> parse(std::string_view type, std::string_view text);

  [[nodiscard]] const Message& root() const { return messages_.front(); }
  [[nodiscard]] const Message& message(size_t index) const { return messages_[index]; }

 private:
  friend class DefinitionParser;

  MessageDefinition() = default;

  std::vector<Message> messages_;
};

/// Returns "sensor_msgs/Image" for "sensor_msgs/msg/Image".
[[nodiscard]] std::string plain_type_name(std::string_view type);

}  // namespace engram::datasets::ros
