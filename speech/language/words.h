// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/status.h"

namespace engram::speech {

/// Whether a word is one of these.
[[nodiscard]] inline bool is_any(std::string_view word,
                                 std::initializer_list<std::string_view> these) {
  return std::find(these.begin(), these.end(), word) != these.end();
}

/// One word of a question.
struct QuestionWord {
  std::string text;   ///< In lower case, contractions written out: "did", "not".
  std::string given;  ///< As it was written.
  bool begins_sentence = false;
  bool is_capital = false;      ///< Its first letter was one, and the word is not all capitals.
  bool ends_clause = false;     ///< A comma, a full stop or the like follows.
  bool is_corrected = false;    ///< It was mistyped.
  bool ends_statement = false;  ///< A full stop or an exclamation mark follows.
};

/// What a question may be: longer ones are refused before anything is made of them.
inline constexpr size_t kMaxQuestionBytes = 2000;
inline constexpr size_t kMaxQuestionWords = 120;

/// Splits a question into words. Curly quotes are straight ones; other signs than letters, digits
/// and those of times end a word; contractions are written out. Errors: kInvalidArgument, in words
/// that may be told to whoever asked: it is empty, too long, no text, in letters that are not
/// English, or has signs of queries, markup or code.
Result<std::vector<QuestionWord>> split_words(std::string_view question);

/// The base form of a verb or noun as the word lists here have it: "picked" and "picking" are
/// "pick", "took" is "take". A word that is not known stays as it is.
[[nodiscard]] std::string lemma_of(const std::string& word);

/// The forms of verbs and nouns that no ending makes: "took", "failure".
[[nodiscard]] std::vector<std::string> irregular_words();

/// "three" is 3, "a" is 1, "12" is 12, of words up to "hundred"; -1 is no number.
[[nodiscard]] int number_named(std::string_view word);

/// How many letters must change, be added, left out or swapped with their neighbour to make one
/// word of the other, up to `max`; max + 1 for more.
[[nodiscard]] int letters_apart(std::string_view a, std::string_view b, int max);

}  // namespace engram::speech
