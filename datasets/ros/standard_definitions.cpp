// SPDX-License-Identifier: Apache-2.0
#include "datasets/ros/standard_definitions.h"

#include <algorithm>
#include <array>

namespace engram::datasets::ros {

namespace {

#define ENGRAM_LINE \
  "================================================================================\n"
#define ENGRAM_ROS2_HEADER          \
  ENGRAM_LINE                       \
  "MSG: std_msgs/Header\n"          \
  "builtin_interfaces/Time stamp\n" \
  "string frame_id\n" ENGRAM_LINE   \
  "MSG: builtin_interfaces/Time\n"  \
  "int32 sec\n"                     \
  "uint32 nanosec\n"
#define ENGRAM_ROS1_HEADER \
  ENGRAM_LINE              \
  "MSG: std_msgs/Header\n" \
  "uint32 seq\n"           \
  "time stamp\n"           \
  "string frame_id\n"
#define ENGRAM_IMAGE         \
  "std_msgs/Header header\n" \
  "uint32 height\n"          \
  "uint32 width\n"           \
  "string encoding\n"        \
  "uint8 is_bigendian\n"     \
  "uint32 step\n"            \
  "uint8[] data\n"
#define ENGRAM_COMPRESSED_IMAGE \
  "std_msgs/Header header\n"    \
  "string format\n"             \
  "uint8[] data\n"
#define ENGRAM_JOINT_STATE   \
  "std_msgs/Header header\n" \
  "string[] name\n"          \
  "float64[] position\n"     \
  "float64[] velocity\n"     \
  "float64[] effort\n"

struct Definition {
  std::string_view type;
  std::string_view ros1;
  std::string_view ros2;
};
constexpr std::array<Definition, 4> kDefinitions{{
    {"sensor_msgs/Image", ENGRAM_IMAGE ENGRAM_ROS1_HEADER, ENGRAM_IMAGE ENGRAM_ROS2_HEADER},
    {"sensor_msgs/CompressedImage", ENGRAM_COMPRESSED_IMAGE ENGRAM_ROS1_HEADER,
     ENGRAM_COMPRESSED_IMAGE ENGRAM_ROS2_HEADER},
    {"sensor_msgs/JointState", ENGRAM_JOINT_STATE ENGRAM_ROS1_HEADER,
     ENGRAM_JOINT_STATE ENGRAM_ROS2_HEADER},
    {"std_msgs/String", "string data\n", "string data\n"},
}};

#undef ENGRAM_LINE
#undef ENGRAM_ROS2_HEADER
#undef ENGRAM_ROS1_HEADER
#undef ENGRAM_IMAGE
#undef ENGRAM_COMPRESSED_IMAGE
#undef ENGRAM_JOINT_STATE

}  // namespace

std::optional<std::string_view> standard_definition(std::string_view type,
                                                    Serialization serialization) {
  const auto* found = std::ranges::find(kDefinitions, type, &Definition::type);
  if (found == kDefinitions.end()) return std::nullopt;
  return serialization == Serialization::kRos1 ? found->ros1 : found->ros2;
}

}  // namespace engram::datasets::ros
