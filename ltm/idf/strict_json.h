// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string_view>

#include "ltm/core/status.h"

namespace engram::idf {

/// Parses JSON from outside. What parsers usually let pass, and then guess, is an error: two equal
/// keys of an object, of which one value would be lost, and integers beyond 64 bits, which would
/// lose digits as floats.
/// Errors: kInvalidArgument, also where it nests deeper than `max_levels`.
Result<nlohmann::ordered_json> parse_json(std::string_view text, int max_levels);

}  // namespace engram::idf
