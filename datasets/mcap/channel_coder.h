// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <optional>
#include <string>

#include "datasets/mcap/mcap_records.h"
#include "datasets/ros/message_type.h"
#include "ltm/memory/memory_id.h"

namespace engram::datasets::mcap {

/// Key of a channel's metadata that names the entity that was written as this channel, if that
/// entity was not imported.
inline constexpr const char* kEntityKey = "engram:entity";

/// Attribute of the stream that contains the attachments of a file.
inline constexpr const char* kAttachments = "attachments";

/// Converts the messages of one channel to values and back. ROS 1 and ROS 2 messages are converted
/// by their definitions, and JSON as such. All others, and messages whose definition cannot be
/// read, become {"encoding", "schema", "bytes"}.
///
/// Threading: immutable, const-parallel.
class ChannelCoder {
 public:
  /// `schema` may be null.
  static ChannelCoder create(const ChannelRecord& channel, const SchemaRecord* schema);

  /// Safe on hostile bytes. Errors: kDataLoss.
  [[nodiscard]] Result<idf::Data> decode(std::span<const std::byte> bytes) const;

  /// Errors: kInvalidArgument if a value is not a message of this channel.
  [[nodiscard]] Result<std::vector<std::byte>> encode(const idf::Data& value,
                                                      int jpeg_quality) const;

  /// Null if the messages are not ROS messages.
  [[nodiscard]] const ros::MessageType* ros_type() const { return ros_ ? &*ros_ : nullptr; }

  /// Says why messages with a definition are kept as bytes; empty if they are not.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  enum class Form : uint8_t { kBytes, kRos, kJson, kOwnJson };

  Form form_ = Form::kBytes;
  std::optional<ros::MessageType> ros_;
  bool is_own_ = false;  ///< The channel was written for an entity that was not imported.
  std::string encoding_;
  std::string schema_name_;
  std::string problem_;
};

}  // namespace engram::datasets::mcap
