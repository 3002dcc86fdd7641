// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "speech/language/words.h"
#include "speech/program/period.h"

namespace engram::speech {

/// The times of a question, in the words of programs (speech/program/period.h).
struct AskedTimes {
  std::optional<std::string> during;
  std::optional<std::string> at;
  std::optional<std::string> after;
  std::optional<std::string> before;
  bool is_now = false;     ///< The present was asked for in words.
  bool is_future = false;  ///< Tomorrow and the like, of which no memory tells.

  [[nodiscard]] bool empty() const { return !during && !at && !after && !before; }
};

/// Takes the words that tell of times out of a question. "Before" and "after" that are followed by
/// no time stay.
AskedTimes take_times(std::vector<QuestionWord>& words, Time now, DayZone zone);

}  // namespace engram::speech
