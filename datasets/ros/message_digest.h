// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "ltm/core/status.h"

namespace engram::datasets::ros {

/// The MD5 sum by which programs of ROS 1 know that they mean the same messages: of constants, then
/// fields, with the sums of messages in the place of their names.
///
/// `type` is "sensor_msgs/Image", `text` as MessageDefinition::parse takes it. Gives 32 hexadecimal
/// digits.
/// Errors: kInvalidArgument naming what is defined nowhere, or nests deeper than 32;
/// kFailedPrecondition where OpenSSL has no MD5.
/// Source: genmsg 0.6.0, gentools; docs/formats.md, "rosbag".
Result<std::string> message_md5(std::string_view type, std::string_view text);

}  // namespace engram::datasets::ros
