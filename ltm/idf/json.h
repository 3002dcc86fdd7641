// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "ltm/idf/binary.h"

namespace engram::idf {

/// Writes JSON that reads back to the identical value.
///
/// none, bool, string, int64, float64, list and dict are plain JSON. Values that JSON would change
/// carry their type: {"$int32": 5}, {"$int64": "9007199254740993"} beyond 2^53, {"$float32": 1.5},
/// {"$float64": "nan"} (with its bits unless it is the plain NaN), {"$ndarray": {"type": "float32",
/// "shape": [3], "data": [1, 2, 3]}}, with "base64" instead of "data" from 64 elements on. A dict
/// key that starts with '$' gets a second one in front.
/// Errors: kInvalidArgument where the value nests deeper than `max_depth` or a string is no UTF-8.
Result<nlohmann::ordered_json> to_json(const Data& data, int max_depth = kMaxDepth);

/// Writes the text of to_json; `indent` < 0 writes one line.
Result<std::string> to_json_text(const Data& data, int indent = -1, int max_depth = kMaxDepth);

/// Reads what to_json wrote.
/// Errors: kInvalidArgument naming the path, what was found and what was needed.
Result<Data> from_json(const nlohmann::ordered_json& json, int max_depth = kMaxDepth);
Result<Data> from_json_text(std::string_view text, int max_depth = kMaxDepth);

}  // namespace engram::idf
