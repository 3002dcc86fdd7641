// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "ltm/core/status.h"

namespace engram::experiments {

enum class BagCompression { kNone, kLz4, kBz2 };

/// A ROS 1 bag. The header uses neither ROS nor C++20, because ROS's messages compile only up to
/// C++17.
///
/// The put functions make messages, and write() writes them together.
/// Errors: every function returns kUnavailable with rosbag's message.
/// Threading: one thread.
class BagFile {
 public:
  BagFile();
  ~BagFile();

  Status create(const std::string& path, BagCompression compression);
  Status open(const std::string& path);
  Status close();

  /// Discards all messages and sets the time of the next ones. Unit: ns since the Unix epoch.
  void begin(int64_t time_ns);
  /// Makes a sensor_msgs/JointState. Unit: rad, rad/s.
  void put_joints(const double* positions, const double* velocities, size_t count);
  /// Makes a sensor_msgs/Image, rgb8.
  void put_image(const std::string& topic, const uint8_t* pixels, uint32_t width, uint32_t height);
  /// Makes a geometry_msgs/PoseStamped with a rotation about the vertical axis. Unit: m, rad.
  void put_pose(const std::string& topic, double x, double y, double angle);
  /// Makes a std_msgs/String.
  void put_text(const std::string& text);
  Status write();

  /// Returns the pixels of the image at exactly this time.
  /// Errors: also kNotFound.
  Result<std::shared_ptr<const std::vector<uint8_t>>> image(const std::string& topic,
                                                            int64_t time_ns);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace engram::experiments
