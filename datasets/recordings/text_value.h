// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "ltm/idf/data.h"

namespace engram::datasets {

/// Converts text from a file to a value; the value has bytes if the text is not UTF-8.
[[nodiscard]] idf::Data text_value(std::string_view text);

/// Converts such a value back to text. Other values, and null, give empty text.
[[nodiscard]] std::string text_of(const idf::Data* value);

}  // namespace engram::datasets
