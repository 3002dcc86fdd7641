// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "ltm/core/status.h"

namespace engram::experiments {

enum class BagCompression { kNone, kLz4, kBz2 };

/// A ROS 1 bag, in types that need neither ROS nor C++20: ROS's messages compile up to C++17 only.
///
/// Messages are made by the put functions and written together by write.
/// Errors: kUnavailable with what rosbag said, everywhere.
/// Threading: one thread.
class BagFile {
 public:
  BagFile();
  ~BagFile();

  Status create(const std::string& path, BagCompression compression);
  Status open(const std::string& path);
  Status close();

  /// Forgets what was put; times are nanoseconds since the Unix epoch.
  void begin(int64_t time_ns);
  /// sensor_msgs/JointState. Unit: rad, rad/s.
  void put_joints(const double* positions, const double* velocities, size_t count);
  /// sensor_msgs/Image, rgb8.
  void put_image(const std::string& topic, const uint8_t* pixels, uint32_t width, uint32_t height);
  /// geometry_msgs/PoseStamped, turned about the vertical axis. Unit: m, rad.
  void put_pose(const std::string& topic, double x, double y, double angle);
  /// std_msgs/String.
  void put_text(const std::string& text);
  Status write();

  /// The pixels of the image of exactly this time.
  /// Errors: kNotFound too.
  Result<std::shared_ptr<const std::vector<uint8_t>>> image(const std::string& topic,
                                                            int64_t time_ns);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace engram::experiments
