// SPDX-License-Identifier: Apache-2.0
#include "speech/language/asker.h"

#include "ltm/core/utf8.h"
#include "speech/language/grammar.h"
#include "speech/program/execute.h"
#include "speech/telling/tell_outcome.h"

namespace engram::speech {

namespace {

/// A question as an answer repeats it: what is far too long is cut off.
std::string shown_question(std::string_view question) {
  constexpr size_t kMaxShown = 500;
  const std::string shown(cut_utf8(question, kMaxShown));
  return shown.size() < question.size() ? shown + "..." : shown;
}

}  // namespace

nlohmann::ordered_json Answer::to_json() const {
  nlohmann::ordered_json json{
      {"question", question}, {"text", text}, {"route", route}, {"confidence", confidence}};
  json["program"] = program ? nlohmann::ordered_json(program->to_string()) : nullptr;
  json["value"] = speech::to_json(value);
  json["evidence"] = nlohmann::ordered_json::array();
  for (const Evidence& one : evidence)
    json["evidence"].push_back({{"id", one.id.to_string()}, {"role", one.role}});
  json["looked_for"] = looked_for;
  json["took_ms"] = took_ms;
  return json;
}

Asker::Asker(std::unique_ptr<KnownFacts> facts, const Options& options)
    : facts_(std::move(facts)),
      options_(options),
      tagger_(make_word_tagger()),
      lexicon_(std::make_unique<Lexicon>(*facts_)) {}

Result<std::unique_ptr<Asker>> Asker::create(Memory& memory, const Options& options) {
  ENGRAM_ASSIGN_OR_RETURN(std::unique_ptr<KnownFacts> facts, KnownFacts::read(memory));
  return std::unique_ptr<Asker>(new Asker(std::move(facts), options));
}

Status Asker::refresh() {
  ENGRAM_RETURN_IF_ERROR(facts_->refresh());
  lexicon_ = std::make_unique<Lexicon>(*facts_);
  return {};
}

Result<Answer> Asker::ask_parsed(ParsedQuestion parsed, Time now) {
  auto executed = parsed.program ? ask_program(*parsed.program, now) : Result<Answer>(Answer());
  // Times that make no sense at this moment are the question's fault: "from now to 8:00".
  if (!executed.ok() && executed.status().code() == StatusCode::kInvalidArgument) {
    parsed.refusal = "I am sorry, I do not understand when you mean.";
    parsed.program.reset();
    executed = Answer();
  }
  ENGRAM_RETURN_IF_ERROR(executed.status());
  executed->confidence = parsed.confidence;
  if (parsed.program) return executed;
  executed->text = std::move(parsed.refusal);
  executed->route = "none";
  executed->looked_for = "a question that I can read";
  return executed;
}

Result<Answer> Asker::ask_both(const QuestionInWords& question, ParsedQuestion parsed, Time now) {
  ENGRAM_ASSIGN_OR_RETURN(const auto read,
                          options_.reader->read(question, *facts_, *lexicon_, now, options_.zone));
  const bool is_by_rule = parsed.program && !parsed.is_unread;
  if (!read || (!is_by_rule && !read->is_told)) return ask_parsed(std::move(parsed), now);
  auto answer = ask_program(read->program, now);
  // Times that make no sense at this moment: it was read wrongly.
  if (!answer.ok() && answer.status().code() == StatusCode::kInvalidArgument)
    return ask_parsed(std::move(parsed), now);
  ENGRAM_RETURN_IF_ERROR(answer.status());
  answer->route = options_.reader->route();
  answer->confidence = read->confidence;
  if (!is_by_rule || read->is_sure) return answer;
  ENGRAM_ASSIGN_OR_RETURN(Answer by_rule, ask_parsed(std::move(parsed), now));
  if (by_rule.value == answer->value) return by_rule;
  return ask_parsed(unread_question(), now);
}

Result<Answer> Asker::ask_words(std::string_view question, Time now, AskRoute route) {
  const auto in_words = question_in_words(question, *lexicon_, *tagger_, now, options_.zone);
  if (!in_words.ok())
    return ask_parsed({.refusal = "I am sorry, " + in_words.status().message() + "."}, now);
  ParsedQuestion parsed =
      route == AskRoute::kReader ? unread_question() : parse_question(*in_words, *lexicon_);
  // What is known to be nothing that a memory answers needs no other reader.
  const bool asks_both = options_.reader != nullptr && route != AskRoute::kProgram &&
                         (parsed.program || parsed.is_unread);
  return asks_both ? ask_both(*in_words, std::move(parsed), now)
                   : ask_parsed(std::move(parsed), now);
}

Result<Answer> Asker::ask(std::string_view question, Time now, AskRoute route) {
  const SteadyTime began = steady_now();
  ENGRAM_ASSIGN_OR_RETURN(Answer answer, ask_words(question, now, route));
  answer.question = shown_question(question);
  answer.took_ms = to_seconds(steady_now() - began) * 1e3;
  return answer;
}

Result<Answer> Asker::ask_program(const Program& program, Time now) {
  const SteadyTime began = steady_now();
  ENGRAM_ASSIGN_OR_RETURN(Outcome outcome, execute(program, *facts_, now, options_.zone));
  Answer answer;
  answer.question = program.to_string();
  answer.text = tell(outcome, *facts_, options_.zone);
  answer.route = "program";
  answer.confidence = 1;
  answer.program = program;
  answer.value = std::move(outcome.value);
  answer.evidence = std::move(outcome.evidence);
  answer.looked_for = outcome.looked_for;
  if (is_unknown(answer.value) && !outcome.missing.empty())
    answer.looked_for += ": " + outcome.missing;
  answer.took_ms = to_seconds(steady_now() - began) * 1e3;
  return answer;
}

}  // namespace engram::speech
