// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "speech/attention/attention_input.h"
#include "speech/attention/episode_groups.h"
#include "speech/language/question_reader.h"

namespace engram::speech {

/// A network that attends to what a memory has of a question (speech/learning).
///
/// Threading: one thread.
class AttentionNetwork {
 public:
  virtual ~AttentionNetwork() = default;

  /// Errors: kUnavailable where the network fails.
  virtual Result<AttentionScores> attend(const AttentionInput& input) = 0;
  /// The confidence from which on what it reads is told: enough of that was right, as measured on
  /// questions that it was not trained with.
  [[nodiscard]] virtual double min_confidence() const = 0;
  /// The same of what counts more than the rules of the grammar.
  [[nodiscard]] virtual double sure_confidence() const = 0;
};

/// A question with what a memory has of it, for a network and for who chooses the program.
struct AttendedQuestion {
  AskedNames names;
  AskedTimes times;
  std::vector<EpisodeGroup> groups;
  AttentionInput input;
};

/// Errors: kInvalidArgument where it has too many words to be a question; those of Memory::query.
Result<AttendedQuestion> attended_question(const QuestionInWords& question, KnownFacts& facts,
                                           const Lexicon& lexicon, Time now, DayZone zone);

/// Reads questions by attention: the network tells a program, and the groups of episodes that it is
/// about (choose_program()).
///
/// Owns: the network.
/// Threading: one thread.
/// Source: docs/verbalisation.md, section "The route of attention".
[[nodiscard]] std::unique_ptr<QuestionReader> make_attention_reader(
    std::unique_ptr<AttentionNetwork> network);

}  // namespace engram::speech
