// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "datasets/ros/message_type.h"

namespace engram::datasets::ros {

// Message types for values that were not imported from messages.

/// Returns "sensor_msgs/Image" (or CompressedImage if `is_compressed` is true) for values with
/// nothing but an image or a depth, and "sensor_msgs/JointState" for values with nothing but name,
/// position, velocity, effort. Empty for all others, which these messages cannot hold unchanged.
[[nodiscard]] std::string_view suited_type(const idf::Data& value, bool is_compressed);

/// Encodes the message of such a value. `stamp` goes into the header if there is one and it can
/// hold it.
/// Errors: kInvalidArgument if the value itself has a header or an encoding, which reading would
/// remove; those of MessageType::encode.
Result<std::vector<std::byte>> encode_bare(const MessageType& type, const idf::Data& value,
                                           int jpeg_quality, std::optional<Time> stamp = {});

/// Returns the value without the members that such a message adds.
[[nodiscard]] idf::Data without_header(const idf::Data& value);

}  // namespace engram::datasets::ros
