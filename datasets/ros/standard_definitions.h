// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

namespace engram::datasets::ros {

/// Definitions, as ROS 2 has them, of what is written for entities that no import made:
/// sensor_msgs/Image, CompressedImage and JointState. Nothing for other types.
[[nodiscard]] std::optional<std::string_view> standard_definition(std::string_view type);

}  // namespace engram::datasets::ros
