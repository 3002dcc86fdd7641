// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "datasets/ros/message_type.h"

namespace engram::datasets::ros {

// As what values are written that no import of messages made.

/// "sensor_msgs/Image" (or CompressedImage, for an image that shall be compressed) for nothing but
/// an image or a depth, "sensor_msgs/JointState" for nothing but name, position, velocity, effort.
/// Empty for all others, which these messages do not hold as they are.
[[nodiscard]] std::string_view suited_type(const idf::Data& value, bool is_compressed);

/// The message of such a value. `stamp` goes into its header, where it has one and that holds it.
/// Errors: kInvalidArgument where the value has a header or an encoding itself, which reading would
/// take from it; those of MessageType::encode.
Result<std::vector<std::byte>> encode_bare(const MessageType& type, const idf::Data& value,
                                           int jpeg_quality, std::optional<Time> stamp = {});

/// The value again, without what such a message has beside it.
[[nodiscard]] idf::Data without_header(const idf::Data& value);

}  // namespace engram::datasets::ros
