// SPDX-License-Identifier: Apache-2.0
#include "datasets/ros/standard_definitions.h"

namespace engram::datasets::ros {

namespace {

#define ENGRAM_ROS_HEADER                                                              \
  "================================================================================\n" \
  "MSG: std_msgs/Header\n"                                                             \
  "builtin_interfaces/Time stamp\n"                                                    \
  "string frame_id\n"                                                                  \
  "================================================================================\n" \
  "MSG: builtin_interfaces/Time\n"                                                     \
  "int32 sec\n"                                                                        \
  "uint32 nanosec\n"

constexpr std::string_view kImage =
    "std_msgs/Header header\n"
    "uint32 height\n"
    "uint32 width\n"
    "string encoding\n"
    "uint8 is_bigendian\n"
    "uint32 step\n"
    "uint8[] data\n" ENGRAM_ROS_HEADER;

constexpr std::string_view kCompressedImage =
    "std_msgs/Header header\n"
    "string format\n"
    "uint8[] data\n" ENGRAM_ROS_HEADER;

constexpr std::string_view kJointState =
    "std_msgs/Header header\n"
    "string[] name\n"
    "float64[] position\n"
    "float64[] velocity\n"
    "float64[] effort\n" ENGRAM_ROS_HEADER;

#undef ENGRAM_ROS_HEADER

}  // namespace

std::optional<std::string_view> standard_definition(std::string_view type) {
  if (type == "sensor_msgs/Image") return kImage;
  if (type == "sensor_msgs/CompressedImage") return kCompressedImage;
  if (type == "sensor_msgs/JointState") return kJointState;
  return std::nullopt;
}

}  // namespace engram::datasets::ros
