// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "memory/memory.h"
#include "speech/facts/answer_value.h"
#include "speech/facts/known_facts.h"
#include "speech/language/grammar.h"
#include "speech/language/lexicon.h"
#include "speech/language/question_reader.h"
#include "speech/language/tagger.h"
#include "speech/program/outcome.h"
#include "speech/program/period.h"
#include "speech/program/program.h"

namespace engram::speech {

/// An answer with what it rests on.
struct Answer {
  std::string question;
  std::string text;
  /// "program"; that of the reader who read it, "attention"; "none" where nobody could.
  std::string route;
  double confidence = 0;
  std::optional<Program> program;
  AnswerValue value = answers::Unknown{};
  std::vector<Evidence> evidence;
  std::string looked_for;
  double took_ms = 0;

  /// {"question", "text", "route", "confidence", "program", "value", "evidence", "looked_for",
  /// "took_ms"}.
  [[nodiscard]] nlohmann::ordered_json to_json() const;
};

/// Who reads a question as a program.
enum class AskRoute {
  /// Both: the other reader where no rule fits, or where it is sure; the grammar where both find
  /// the
  /// same, or the other reads nothing. Where they find different things and neither is sure, the
  /// question is not understood.
  kAuto,
  kProgram,  ///< The grammar alone.
  kReader,   ///< The other reader alone.
};

/// Answers questions in English from a memory.
///
/// Owns: nothing of the memory, which must outlive it.
/// Threading: one thread.
/// Source: docs/verbalisation.md.
class Asker {
 public:
  struct Options {
    /// By which clock days and clock times are meant.
    DayZone zone = DayZone::kUtc;
    /// Who reads what the grammar does not, or not so well; null: nobody.
    std::shared_ptr<QuestionReader> reader{};
  };

  /// Reads what the memory has now.
  /// Errors: those of KnownFacts::read().
  static Result<std::unique_ptr<Asker>> create(Memory& memory, const Options& options);

  /// Takes up what the memory was told since.
  Status refresh();

  /// Answers a question as of `now`. What it does not understand, and what the memory does not
  /// know, is no error but an answer that says so.
  /// Errors: those of Memory::query.
  Result<Answer> ask(std::string_view question, Time now, AskRoute route = AskRoute::kAuto);
  /// Answers what is a program already.
  /// Errors: kInvalidArgument where it does not validate; those of Memory::query.
  Result<Answer> ask_program(const Program& program, Time now);

  [[nodiscard]] KnownFacts& facts() { return *facts_; }
  [[nodiscard]] DayZone zone() const { return options_.zone; }

 private:
  Asker(std::unique_ptr<KnownFacts> facts, const Options& options);

  Result<Answer> ask_words(std::string_view question, Time now, AskRoute route);
  Result<Answer> ask_both(const QuestionInWords& question, ParsedQuestion parsed, Time now);
  Result<Answer> ask_parsed(ParsedQuestion parsed, Time now);

  std::unique_ptr<KnownFacts> facts_;
  Options options_;
  std::unique_ptr<Tagger> tagger_;
  std::unique_ptr<Lexicon> lexicon_;
};

}  // namespace engram::speech
