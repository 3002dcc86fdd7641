// SPDX-License-Identifier: Apache-2.0
#include "cli/old_words.h"

#include <algorithm>
#include <array>

namespace engram::cli {

namespace {

/// An option's word of earlier versions, accepted until `kOldWordsUntil`.
struct OldWord {
  std::string_view command;
  std::string_view old;
  std::string_view now;
  std::string_view unless{};  ///< If this word is given too, `old` has its current meaning.
};

constexpr const char* kOldWordsUntil = "0.3";

constexpr std::array kOldWords{
    // Elsewhere these words are the time of everything, numbers of snapshots, and durations.
    OldWord{"crossval", "--budget", "--training"},
    OldWord{"crossval", "--every", "--spacing"},
    OldWord{"crossval", "--ahead", "--max-horizon"},
    OldWord{"predict", "--ahead", "--horizons", "--horizons"},
    OldWord{"recover", "--output", "--out", "--out"},
    OldWord{"commit", "--type-name", "--type"},
    // All other commands call the file --types, and one type of it --type.
    OldWord{"commit", "--type", "--types", "--types"},
};

/// Returns "--out" for "--out=FILE".
std::string_view word_of(std::string_view argument) {
  return argument.substr(0, argument.find('='));
}

}  // namespace

std::string is_now(std::string_view old, std::string_view now) {
  return "'" + std::string(old) + "' is '" + std::string(now) + "' now, and is taken until " +
         kOldWordsUntil;
}

TodaysWords with_todays_words(const std::vector<std::string>& given) {
  TodaysWords todays{given, {}};
  std::vector<std::string>& arguments = todays.arguments;
  const auto command =
      std::ranges::find_if(arguments, [](const std::string& one) { return !one.starts_with('-'); });
  if (command == arguments.end()) return todays;
  const bool is_quiet = std::any_of(arguments.begin(), command, [](const std::string& one) {
    return one == "-q" || one == "--quiet";
  });
  const auto is_given = [&](std::string_view word) {
    return !word.empty() &&
           std::ranges::any_of(given, [&](const auto& one) { return word_of(one) == word; });
  };
  for (auto one = command + 1; one != arguments.end() && *one != "--"; ++one)
    for (const OldWord& word : kOldWords) {
      if (word.command != *command || word.old != word_of(*one) || is_given(word.unless)) continue;
      if (!is_quiet) todays.warnings.push_back(is_now(word.old, word.now));
      one->replace(0, word.old.size(), word.now);
      break;
    }
  return todays;
}

}  // namespace engram::cli
