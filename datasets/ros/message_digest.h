// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "ltm/core/status.h"

namespace engram::datasets::ros {

/// Returns the MD5 sum by which programs of ROS 1 verify that they use the same message type. It
/// covers constants, then fields, with nested messages replaced by their sums.
///
/// `type` is "sensor_msgs/Image", and `text` is as for MessageDefinition::parse. The result has 32
/// hexadecimal digits.
/// Errors: kInvalidArgument naming a type that is not defined, or is nested deeper than 32;
/// kFailedPrecondition if OpenSSL has no MD5.
/// Source: genmsg 0.6.0, gentools; docs/formats.md, "rosbag".
Result<std::string> message_md5(std::string_view type, std::string_view text);

}  // namespace engram::datasets::ros
