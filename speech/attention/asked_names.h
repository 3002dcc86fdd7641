// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "speech/attention/attention_input.h"
#include "speech/language/grammar.h"

namespace engram::speech {

/// The names of a question, each once, in the order in which they stand there.
struct AskedNames {
  std::vector<std::string> things;
  std::vector<std::string> places;
  std::vector<std::string> persons;
  std::vector<std::string> hands;
  /// The skills that each verb, or name of a skill, means: joined by commas.
  std::vector<std::string> skills;
  /// The skills of the memory that each verb of English means, whether the question has it or not:
  /// others have more verbs for them than any list. In the order of skill_verbs(); empty: none.
  std::vector<std::string> skills_of_verbs;

  explicit AskedNames(const QuestionInWords& question, const Lexicon& lexicon);
};

/// The words as a network reads them: of each its spelling, its base form and its tag, of one that
/// nobody knows also its letters; of a name its kind and the place among those of its kind. Behind
/// them stand the times that are asked for. At most AttentionInput::kMaxWords.
[[nodiscard]] std::vector<AttentionInput::Word> numbers_of_words(const QuestionInWords& question,
                                                                 const AskedNames& names);

/// Whether these are the numbers of a name.
[[nodiscard]] bool is_name(const AttentionInput::Word& word);

}  // namespace engram::speech
