// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <optional>
#include <string>

#include "datasets/mcap/mcap_records.h"
#include "datasets/ros/message_type.h"
#include "ltm/memory/memory_id.h"

namespace engram::datasets::mcap {

/// Key of a channel's metadata that names the entity that was written as it, where no import had
/// made that.
inline constexpr const char* kEntityKey = "engram:entity";

/// Attribute of the stream whose values are a file's attachments.
inline constexpr const char* kAttachments = "attachments";

/// The messages of one channel as values, both ways: ROS 1 and ROS 2 by their definitions, JSON;
/// everything else, and what has a definition that cannot be read, as {"encoding", "schema",
/// "bytes"}.
///
/// Threading: immutable, const-parallel.
class ChannelCoder {
 public:
  /// `schema` may be null.
  static ChannelCoder create(const ChannelRecord& channel, const SchemaRecord* schema);

  /// Safe on hostile bytes. Errors: kDataLoss.
  [[nodiscard]] Result<idf::Data> decode(std::span<const std::byte> bytes) const;

  /// Errors: kInvalidArgument where a value is not what the channel's messages are.
  [[nodiscard]] Result<std::vector<std::byte>> encode(const idf::Data& value,
                                                      int jpeg_quality) const;

  /// Null where messages are not those of ROS.
  [[nodiscard]] const ros::MessageType* ros_type() const { return ros_ ? &*ros_ : nullptr; }

  /// Why messages with a definition are kept as bytes; empty: they are not.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  enum class Form : uint8_t { kBytes, kRos, kJson, kOwnJson };

  Form form_ = Form::kBytes;
  std::optional<ros::MessageType> ros_;
  bool is_own_ = false;  ///< Written for an entity that no import made.
  std::string encoding_;
  std::string schema_name_;
  std::string problem_;
};

}  // namespace engram::datasets::mcap
