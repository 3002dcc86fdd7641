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

/// Whether a word asks for something: "who", "what", "how".
[[nodiscard]] bool is_question_word(std::string_view word);

/// Whether a word begins what asks whether: "did", "have", "could".
[[nodiscard]] bool is_auxiliary(std::string_view word);

/// Whether a word stands before a name: "the", "my", "some".
[[nodiscard]] bool is_article(std::string_view word);

/// All spellings of the words above, for whoever mistypes one.
[[nodiscard]] const std::set<std::string>& english_spellings();

/// Takes polite and roundabout beginnings off: "Could you please tell me", "I would like to know".
/// Where whether something is so was asked for, "whether" stays in their place: "Please confirm
/// that". Returns whether there was one that makes a question of what follows.
bool take_politeness(std::vector<QuestionWord>& words);

/// Takes off what makes a question of a statement: "You picked it up, didn't you?", "Is that so?",
/// "yes or no?". "Whether" is put before the statement.
void take_question_tags(std::vector<QuestionWord>& words);

/// Puts "whether" before the sentence or clause that begins at a word.
void put_whether(std::vector<QuestionWord>& words, size_t at);

/// Takes off how somebody calls whom he talks to: "my dear", "sweetheart".
void take_endearments(std::vector<QuestionWord>& words);

}  // namespace engram::speech
