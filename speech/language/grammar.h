// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "speech/language/lexicon.h"
#include "speech/language/tagger.h"
#include "speech/language/time_words.h"
#include "speech/program/period.h"
#include "speech/program/program.h"

namespace engram::speech {

/// A question in words that are tagged, with the times that it tells of taken out.
struct QuestionInWords {
  std::vector<TaggedWord> words;
  AskedTimes times;
  bool is_indirect = false;  ///< It followed "tell me" or the like.
  bool is_order = false;     ///< It begins as an order to forget or to pretend something.
  bool is_stated = false;    ///< A full stop or an exclamation mark ended it.
};

/// Errors: kInvalidArgument as split_words(), in words that may be told to whoever asked.
Result<QuestionInWords> question_in_words(std::string_view question, const Lexicon& lexicon,
                                          const Tagger& tagger, Time now, DayZone zone);

/// A question as a program, or why it is none.
struct ParsedQuestion {
  std::optional<Program> program;
  std::string refusal;    ///< A polite sentence; empty where there is a program.
  double confidence = 0;  ///< 0..1: less where words were corrected or passed over.
  /// No rule fits, or a word that nobody knows was taken for a name, which says little about what
  /// the words mean. Else it is known what they mean, or that no memory answers it.
  bool is_unread = false;
};

/// A question that was not read.
[[nodiscard]] ParsedQuestion unread_question();

/// Reads a question as a program: its clauses, and then the first rule that fits. A name that the
/// memory does not have becomes part of the program all the same, whose execution then says that
/// nothing is called so.
///
/// Complexity: bounded by the length of a question (speech/language/words.h).
[[nodiscard]] ParsedQuestion parse_question(const QuestionInWords& question,
                                            const Lexicon& lexicon);

}  // namespace engram::speech
