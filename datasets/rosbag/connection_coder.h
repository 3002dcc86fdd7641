// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <optional>
#include <string>
#include <vector>

#include "datasets/ros/message_type.h"
#include "datasets/rosbag/bag_records.h"
#include "ltm/memory/memory_id.h"

namespace engram::datasets::rosbag {

/// Field of a connection's header that names the entity that was written as this connection, if
/// that entity was not imported.
inline constexpr std::string_view kEntityField = "engram:entity";

/// Field beside it that says which part of a value the text of a std_msgs/String is. Without it,
/// the value is the message itself.
inline constexpr std::string_view kFormField = "engram:form";

/// Returns the MD5 sum of a connection's messages; "*", which readers of ROS accept for any type,
/// if they cannot be understood or OpenSSL has no MD5.
[[nodiscard]] std::string md5_or_any(const std::string& type, const std::string& definition);

/// Makes the connection for values like `value` of an entity that was not imported. Pictures,
/// joints and texts become standard messages with the same content; all others become JSON in
/// std_msgs/String. `id` and `topic` are used unchanged.
[[nodiscard]] Connection own_connection(uint32_t id, std::string topic, const ltm::MemoryId& entity,
                                        const idf::Data& value, bool is_compressed);

/// Converts the messages of one connection to values and back, by their definition. Messages whose
/// definition cannot be read become {"type", "bytes"}.
///
/// Threading: immutable, const-parallel.
class ConnectionCoder {
 public:
  static ConnectionCoder create(const Connection& connection);

  struct Decoded {
    idf::Data value;
    std::optional<Time> stamp;  ///< The stamp of the message's header, or of its first element.
  };
  /// Safe on hostile bytes. Errors: kDataLoss.
  [[nodiscard]] Result<Decoded> decode(std::span<const std::byte> bytes) const;

  /// `created` becomes the stamp of messages that have a header, if the value has none.
  /// Errors: kInvalidArgument if the value is not a message of this connection.
  [[nodiscard]] Result<std::vector<std::byte>> encode(const idf::Data& value, Time created,
                                                      int jpeg_quality) const;

  /// Null if the definition cannot be read.
  [[nodiscard]] const ros::MessageType* type() const { return ros_ ? &*ros_ : nullptr; }

  /// Returns true if the messages are texts that hold JSON.
  [[nodiscard]] bool is_json() const { return form_ == Form::kJson; }

  /// Says why messages are kept as bytes; empty if they are not.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  enum class Form : uint8_t {
    kBytes,
    kMessage,
    kBare,    ///< A message for an entity that was not imported, as are the next ones.
    kText,    ///< The text of {"text"}.
    kString,  ///< The value is a text.
    kJson,
  };

  [[nodiscard]] Result<idf::Data> value_of(std::string text) const;
  [[nodiscard]] Result<std::string> text_of_value(const idf::Data& value) const;

  Form form_ = Form::kBytes;
  std::optional<ros::MessageType> ros_;
  std::string type_;
  std::string problem_;
};

}  // namespace engram::datasets::rosbag
