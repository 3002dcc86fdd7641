// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "speech/language/words.h"

namespace engram::speech::testing {

/// The words of a question; a failure of the test where it has none.
[[nodiscard]] std::vector<QuestionWord> words_of(std::string_view question);

/// Their texts, separated by spaces.
[[nodiscard]] std::string joined(const std::vector<QuestionWord>& words);

}  // namespace engram::speech::testing
