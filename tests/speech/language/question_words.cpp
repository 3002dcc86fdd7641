// SPDX-License-Identifier: Apache-2.0
#include "tests/speech/language/question_words.h"

#include "tests/ltm/expect_status.h"

namespace engram::speech::testing {

std::vector<QuestionWord> words_of(std::string_view question) {
  auto words = split_words(question);
  EXPECT_OK(words);
  return words.ok() ? *std::move(words) : std::vector<QuestionWord>();
}

std::string joined(const std::vector<QuestionWord>& words) {
  std::string text;
  for (const QuestionWord& word : words) text += (text.empty() ? "" : " ") + word.text;
  return text;
}

}  // namespace engram::speech::testing
