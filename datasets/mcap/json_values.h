// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <string>
#include <string_view>

#include "ltm/idf/data.h"

namespace engram::datasets::mcap {

/// Plain JSON of other people as a value: whole numbers are int64 (an ndarray of one uint64 where
/// they exceed that), others doubles, null is None. Of equal keys the last one counts.
/// Errors: kDataLoss naming where it is no JSON, or nests deeper than 64.
Result<idf::Data> value_of_json(std::string_view text);

/// The same the other way.
/// Errors: kInvalidArgument where JSON of that kind cannot hold it: other ndarrays, floats of 32
/// bits, numbers that are not finite.
Result<std::string> json_of_value(const idf::Data& value);

}  // namespace engram::datasets::mcap
