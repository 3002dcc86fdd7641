// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "speech/facts/known_facts.h"
#include "speech/language/grammar.h"
#include "speech/language/lexicon.h"
#include "speech/program/period.h"
#include "speech/program/program.h"

namespace engram::speech {

/// What a question was read as.
struct ReadProgram {
  Program program;
  double confidence = 0;  ///< 0..1: that it was read rightly.
  bool is_told = false;   ///< Sure enough to be told where the grammar reads nothing.
  /// So sure that it counts more than a rule of the grammar, which may have passed over what
  /// matters.
  bool is_sure = false;
};

/// Another way to read questions as programs than the grammar's (speech/attention).
///
/// Threading: one thread.
class QuestionReader {
 public:
  virtual ~QuestionReader() = default;

  /// What an answer calls it: "attention".
  [[nodiscard]] virtual std::string_view route() const = 0;

  /// Nothing: it reads no program, or that nothing of the memory answers the question.
  /// Errors: those of Memory::query.
  virtual Result<std::optional<ReadProgram>> read(const QuestionInWords& question,
                                                  KnownFacts& facts, const Lexicon& lexicon,
                                                  Time now, DayZone zone) = 0;
};

}  // namespace engram::speech
