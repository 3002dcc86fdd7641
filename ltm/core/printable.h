// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace engram {

/// Returns a text as a person may read it on a terminal or in a log. Names come from anywhere, and
/// a terminal would obey the sequences in them, or show a line that nobody wrote. So control
/// characters, those that turn the direction of writing, and bytes that are no UTF-8 are written as
/// "\n", "\x1b" or "\u202e". All else stays, backslashes too: such a text cannot be read back.
[[nodiscard]] std::string printable(std::string_view text);

/// The same of a text of several lines: line feeds and tabs stay.
[[nodiscard]] std::string printable_lines(std::string_view text);

/// The same of JSON, in which escapes like "\u202e" mean the very characters. Line feeds stay.
[[nodiscard]] std::string printable_json(std::string_view json);

}  // namespace engram
