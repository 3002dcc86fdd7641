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

/// Field of a connection's header that names the entity that was written as it, where no import had
/// made that.
inline constexpr std::string_view kEntityField = "engram:entity";

/// Field beside it: what of a value the text of a std_msgs/String is. None: the value is the
/// message.
inline constexpr std::string_view kFormField = "engram:form";

/// The MD5 sum of a connection's messages; "*", which readers of ROS take for any, where they
/// cannot be understood or OpenSSL has no MD5.
[[nodiscard]] std::string md5_or_any(const std::string& type, const std::string& definition);

/// The connection for values like `value` of an entity that no import made: pictures, joints and
/// texts become messages that say the same, all others JSON in std_msgs/String.
/// `id` and `topic` are set as they are given.
[[nodiscard]] Connection own_connection(uint32_t id, std::string topic, const ltm::MemoryId& entity,
                                        const idf::Data& value, bool is_compressed);

/// The messages of one connection as values, both ways, by their definition; those whose definition
/// cannot be read as {"type", "bytes"}.
///
/// Threading: immutable, const-parallel.
class ConnectionCoder {
 public:
  static ConnectionCoder create(const Connection& connection);

  struct Decoded {
    idf::Data value;
    std::optional<Time> stamp;  ///< Of the header of the message, or what is in it first.
  };
  /// Safe on hostile bytes. Errors: kDataLoss.
  [[nodiscard]] Result<Decoded> decode(std::span<const std::byte> bytes) const;

  /// `created` becomes the stamp of messages that have a header which the value has not.
  /// Errors: kInvalidArgument where the value is not what the connection's messages are.
  [[nodiscard]] Result<std::vector<std::byte>> encode(const idf::Data& value, Time created,
                                                      int jpeg_quality) const;

  /// Null where the definition cannot be read.
  [[nodiscard]] const ros::MessageType* type() const { return ros_ ? &*ros_ : nullptr; }

  /// Whether messages are texts that hold JSON.
  [[nodiscard]] bool is_json() const { return form_ == Form::kJson; }

  /// Why messages are kept as bytes; empty: they are not.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  enum class Form : uint8_t {
    kBytes,
    kMessage,
    kBare,    ///< Like those below, of an entity that no import made.
    kText,    ///< {"text"}
    kString,  ///< A text itself.
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
