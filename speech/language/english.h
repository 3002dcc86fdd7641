// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: words that English has for questions, whatever a memory knows.

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "speech/language/words.h"

namespace engram::speech {

/// Whether rules of the grammar look at this lemma.
[[nodiscard]] bool is_grammar_lemma(const std::string& lemma);

/// Whether a word says nothing that an answer depends on: "please", "the", "earlier".
[[nodiscard]] bool is_filler(const std::string& word);

/// All spellings of the words above, for whoever mistypes one.
[[nodiscard]] const std::set<std::string>& english_spellings();

/// Takes polite and roundabout beginnings off: "Could you please tell me", "I would like to know".
/// Returns whether there was one that makes a question of what follows.
bool take_politeness(std::vector<QuestionWord>& words);

/// The words of a phrase, which are split by spaces.
[[nodiscard]] std::vector<std::string_view> parts_of_phrase(std::string_view phrase);

/// Whether these words begin at `at`.
[[nodiscard]] bool is_phrase_at(const std::vector<QuestionWord>& words, size_t at,
                                const std::vector<std::string_view>& phrase);

/// Puts one word where people use several: "how come" is why, "what time" is when, "how many times"
/// is how often.
void replace_phrases(std::vector<QuestionWord>& words);

}  // namespace engram::speech
