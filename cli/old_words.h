// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace engram::cli {

/// Arguments in the words of this version.
struct TodaysWords {
  std::vector<std::string> arguments;
  std::vector<std::string> warnings;  ///< Of each old word what stands in its place; -q: none.
};

/// Replaces options' words of earlier versions, which are taken for two minor versions.
[[nodiscard]] TodaysWords with_todays_words(const std::vector<std::string>& given);

/// Says that a word of earlier versions has another one in its place.
[[nodiscard]] std::string is_now(std::string_view old, std::string_view now);

}  // namespace engram::cli
