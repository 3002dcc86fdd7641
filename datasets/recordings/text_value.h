// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "ltm/idf/data.h"

namespace engram::datasets {

/// Text of a file as a value: bytes where it is no UTF-8.
[[nodiscard]] idf::Data text_value(std::string_view text);

/// The same the other way; empty for other values, and for null.
[[nodiscard]] std::string text_of(const idf::Data* value);

}  // namespace engram::datasets
