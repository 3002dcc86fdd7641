// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/config.h"
#include "ltm/core/log.h"

namespace engram::ltm {

/// A word of a configuration file and the value that it means.
template <typename T>
struct Choice {
  std::string_view word;
  T value;
  /// Set if it is a word of earlier versions: the word that replaced it.
  std::string_view now{};
};

/// The value that a word means. Warns of old words.
/// Errors: kInvalidArgument listing the known words.
template <typename T, size_t N>
Result<T> choice_of(const ConfigValue& value, const std::array<Choice<T>, N>& choices) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string word, value.text());
  std::vector<std::string> known;
  for (const Choice<T>& choice : choices) {
    if (choice.word == word) {
      if (!choice.now.empty())
        log::warning(
            "{}",
            value.error(fmt::format("'{}' is '{}' now, and is taken until 0.3", word, choice.now))
                .message());
      return choice.value;
    }
    if (choice.now.empty()) known.emplace_back(choice.word);
  }
  return value.error(fmt::format("found '{}', needs one of {}", word, fmt::join(known, ", ")));
}

/// Sets `out` to the value that the word at `key` means, if there is one.
/// Errors: those of choice_of().
template <typename T, size_t N>
Status read_choice(ConfigMap& map, std::string_view key, T& out,
                   const std::array<Choice<T>, N>& choices) {
  const auto value = map.find(key);
  if (!value) return {};
  ENGRAM_ASSIGN_OR_RETURN(out, choice_of(*value, choices));
  return {};
}

/// Reads each value of the list at `key` with `read` and appends it to `out`, if there is a list.
template <typename T>
Status read_list(ConfigMap& map, std::string_view key, std::vector<T>& out,
                 Result<T> (*read)(const ConfigValue&)) {
  const auto value = map.find(key);
  if (!value) return {};
  ENGRAM_ASSIGN_OR_RETURN(const auto values, value->list());
  for (const ConfigValue& each : values) {
    ENGRAM_ASSIGN_OR_RETURN(T made, read(each));
    out.push_back(std::move(made));
  }
  return {};
}

}  // namespace engram::ltm
