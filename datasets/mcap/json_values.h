// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <string>
#include <string_view>

#include "ltm/idf/data.h"

namespace engram::datasets::mcap {

/// Converts any plain JSON to a value. Whole numbers become int64 (an ndarray of one uint64 if they
/// exceed that), others doubles, and null becomes None. Of equal keys the last one is used.
/// Errors: kDataLoss saying where it is not JSON, or is nested deeper than 64.
Result<idf::Data> value_of_json(std::string_view text);

/// Converts a value to plain JSON.
/// Errors: kInvalidArgument if plain JSON cannot hold it: other ndarrays, floats of 32 bits,
/// numbers that are not finite.
Result<std::string> json_of_value(const idf::Data& value);

}  // namespace engram::datasets::mcap
