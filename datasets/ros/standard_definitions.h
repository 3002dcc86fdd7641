// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "datasets/ros/message_definition.h"

namespace engram::datasets::ros {

/// Returns the definitions of the types that are written for entities that no import made:
/// sensor_msgs/Image, CompressedImage and JointState, std_msgs/String. Nothing for other types.
[[nodiscard]] std::optional<std::string_view> standard_definition(
    std::string_view type, Serialization serialization = Serialization::kCdr);

}  // namespace engram::datasets::ros
