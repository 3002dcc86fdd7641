// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <optional>
#include <string>

#include "datasets/ros/message_type.h"
#include "datasets/rosbag/records.h"

namespace engram::datasets::rosbag {

/// The messages of one connection as values, by their definition; those whose definition cannot be
/// read as {"type", "bytes"}.
///
/// Threading: immutable, const-parallel.
class ConnectionCoder {
 public:
  static ConnectionCoder create(const Connection& connection);

  /// Safe on hostile bytes. Errors: kDataLoss.
  [[nodiscard]] Result<idf::Data> decode(std::span<const std::byte> bytes) const;

  /// Null where the definition cannot be read.
  [[nodiscard]] const ros::MessageType* type() const { return ros_ ? &*ros_ : nullptr; }

  /// Why messages are kept as bytes; empty: they are not.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  std::optional<ros::MessageType> ros_;
  std::string type_;
  std::string problem_;
};

}  // namespace engram::datasets::rosbag
