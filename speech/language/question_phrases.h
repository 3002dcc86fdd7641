// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what people say in several words or in many ways.

#include <span>
#include <string_view>
#include <vector>

#include "speech/language/words.h"

namespace engram::speech {

/// A sequence of words, and those that stand for it.
struct Phrase {
  std::string_view words;  ///< A WordPattern.
  std::string_view by;
};

/// Those by which a question word is meant.
[[nodiscard]] std::span<const Phrase> phrases_of_asking();

/// Those of what is done and said, and of what becomes of it.
[[nodiscard]] std::span<const Phrase> phrases_of_deeds();

/// Those of things, places, hands and sight.
[[nodiscard]] std::span<const Phrase> phrases_of_things();

/// The phrase that begins at a word and has most words; null: none begins there.
[[nodiscard]] const Phrase* phrase_at(const std::vector<QuestionWord>& words, size_t at);

/// Puts one word where people use several: "how come" is why, "what time" is when, "how many times"
/// is how often. Of the phrases that begin at a word the longest is taken.
void replace_phrases(std::vector<QuestionWord>& words);

}  // namespace engram::speech
