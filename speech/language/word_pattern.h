// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: sequences of words as tables have them.

#include <span>
#include <string_view>
#include <vector>

#include "speech/language/words.h"

namespace engram::speech {

/// A sequence of words that may be written in several ways: "at what|which time" is "at what time"
/// or "at which time", and "the? reason" may lack the article. A word in it is a pattern itself:
/// alternatives that are separated by '|', and a '?' at the end where none of them need stand
/// there.
///
/// Threading: immutable.
class WordPattern {
 public:
  /// The text must outlive the pattern.
  explicit WordPattern(std::string_view text);

  /// The most words that fit where `at` is; 0: they do not begin there.
  [[nodiscard]] size_t count_at(const std::vector<QuestionWord>& words, size_t at) const;

 private:
  struct Part {
    std::vector<std::string_view> alternatives;
    bool is_optional = false;
  };
  static constexpr size_t kNone = ~size_t{0};

  /// The same for the parts from `part` on; kNone: they do not fit.
  [[nodiscard]] size_t count_from(size_t part, const std::vector<QuestionWord>& words,
                                  size_t at) const;

  std::vector<Part> parts_;
};

/// Several of them, of which the longest that fits counts.
///
/// Threading: immutable.
class WordPatterns {
 public:
  /// The texts must outlive the patterns.
  explicit WordPatterns(std::span<const std::string_view> texts)
      : patterns_(texts.begin(), texts.end()) {}

  /// The most words that fit where `at` is; 0: none begins there.
  [[nodiscard]] size_t count_at(const std::vector<QuestionWord>& words, size_t at) const;

 private:
  std::vector<WordPattern> patterns_;
};

/// Takes words out. What begins a sentence or ends a clause does so without them, too.
void erase_words(std::vector<QuestionWord>& words, size_t at, size_t count);

/// The parts of a text between separators, empty ones left out.
[[nodiscard]] std::vector<std::string_view> parts_between(std::string_view text, char separator);

}  // namespace engram::speech
