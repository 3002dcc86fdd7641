// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace engram::cli {

/// Arguments in the words of this version.
struct TodaysWords {
  std::vector<std::string> arguments;
  std::vector<std::string> warnings;  ///< One per old word, naming the new one; none with -q.
};

/// Replaces options' words of earlier versions, which are accepted for two minor versions.
[[nodiscard]] TodaysWords with_todays_words(const std::vector<std::string>& given);

/// The warning that a word of earlier versions has been replaced.
[[nodiscard]] std::string is_now(std::string_view old, std::string_view now);

}  // namespace engram::cli
