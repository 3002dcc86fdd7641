// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: numbers and poses in values that anybody may have committed.

#include <optional>
#include <string>
#include <vector>

#include "ltm/idf/data.h"
#include "ltm/typed/pose.h"

namespace engram::navigation {

/// An array of `count` finite floats of either width, as doubles.
[[nodiscard]] std::optional<std::vector<double>> finite_numbers(const idf::Data* data,
                                                                int64_t count);

/// The pose that a thing has in one of its members.
/// Errors: kInvalidArgument where there is none, its numbers are not finite, or its orientation is
/// no unit quaternion.
Result<typed::Pose<double>> pose_in(const idf::Data& data, const std::string& member);

}  // namespace engram::navigation
