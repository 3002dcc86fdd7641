// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the text of message definitions.

#include <string_view>

namespace engram::datasets::ros {

/// Max depth of messages within messages.
inline constexpr int kMaxDepth = 32;

inline constexpr std::string_view kSpace = " \t\r";

/// Returns the text without spaces, tabs and carriage returns at both ends.
[[nodiscard]] inline std::string_view trimmed(std::string_view text) {
  const size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

}  // namespace engram::datasets::ros
