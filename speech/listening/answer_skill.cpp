// SPDX-License-Identifier: Apache-2.0
#include "speech/listening/answer_skill.h"

#include <atomic>

#include "ltm/core/log.h"
#include "ltm/core/mutex.h"
#include "server/client/skill_provider.h"
#include "speech/facts/answering.h"
#include "speech/listening/answer_types.h"

namespace engram::speech {

namespace {

/// Its name is kAnsweringSkill.
constexpr const char* kDescription = R"(
doc: Answers a question from what the memory has.
parameters:
  question: {type: string, default: '', doc: What is asked; empty where words ask.}
  words: {type: link, default: '', doc: The words that ask.}
conditions:
  when: {entity: Speech/Commands, path: text, matches: '(?s).*\?\s*', new: true, binds: words}
max_running: 16
timeout: 30s
)";

/// The text of a member; empty where there is none.
std::string text_at(const idf::Data& value, std::string_view member) {
  const idf::Data* found = value.at(member);
  const auto* text = found == nullptr ? nullptr : std::get_if<std::string>(&found->value());
  return text == nullptr ? std::string() : *text;
}

struct Question {
  std::string text;
  std::optional<ltm::MemoryId> words;
  Time now{};
};

class LiveAnswers final : public AnswerSkill {
 public:
  LiveAnswers(std::unique_ptr<Memory> memory, std::unique_ptr<Asker> asker,
              std::unique_ptr<SkillProvider> provider, ltm::MemoryId answers, Options options)
      : memory_(std::move(memory)),
        asker_(std::move(asker)),
        answers_(std::move(answers)),
        options_(std::move(options)),
        provider_(std::move(provider)) {}

  Status register_skill() {
    return provider_->add(fmt::format("name: {}{}", kAnsweringSkill, kDescription),
                          [this](SkillRun& run) { return carry_out(run); });
  }

  [[nodiscard]] size_t answered() const override { return answered_; }

 private:
  SkillEnd carry_out(SkillRun& run) {
    const MutexLock lock(mutex_);
    auto answered = answer(run);
    if (!answered.ok()) return SkillEnd::failure(answered.status().message());
    return *std::move(answered);
  }

  Result<SkillEnd> answer(SkillRun& run) ENGRAM_REQUIRES(mutex_) {
    ENGRAM_RETURN_IF_ERROR(asker_->refresh());
    ENGRAM_ASSIGN_OR_RETURN(const Question question, question_of(run));
    ENGRAM_ASSIGN_OR_RETURN(const Answer answer, asker_->ask(question.text, question.now));
    ++answered_;  // Whoever sees the answer sees that it was counted.
    ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, commit(answer, question, run));
    if (options_.on_answer) options_.on_answer(answer);
    SkillEnd end = SkillEnd::success(answer.text);
    end.links.push_back(id);
    return end;
  }

  Result<Question> question_of(const SkillRun& run) ENGRAM_REQUIRES(mutex_) {
    const std::string link = text_at(run.parameters(), "words");
    Question question{text_at(run.parameters(), "question"), std::nullopt, system_now()};
    if (link.empty()) return question;
    ENGRAM_ASSIGN_OR_RETURN(question.words, ltm::MemoryId::parse(link));
    ENGRAM_ASSIGN_OR_RETURN(const idf::Data value, asker_->facts().value_at(*question.words));
    if (question.text.empty()) question.text = text_at(value, "text");
    // What was said is no part of what is asked about.
    if (question.words->time()) question.now = *question.words->time() - Duration(1);
    return question;
  }

  Result<ltm::MemoryId> commit(const Answer& answer, const Question& question, const SkillRun& run)
      ENGRAM_REQUIRES(mutex_) {
    ::speech::Answer said;
    said.question = answer.question;
    said.answer = answer.text;
    said.command = question.words;
    said.request = run.request();
    said.route = answer.route;
    said.confidence = answer.confidence;
    if (answer.program) said.program = answer.program->to_string();
    said.value = to_json(answer.value)
                     .dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
    said.looked_for = answer.looked_for;
    for (const Evidence& evidence : answer.evidence)
      said.evidence.push_back({.instance = evidence.id, .role = evidence.role});
    said.took = answer.took_ms;
    // Two answers of one moment would be one snapshot.
    last_ = std::max(system_now(), last_ + Duration(1));
    ENGRAM_RETURN_IF_ERROR(memory_->commit({{{answers_, last_, {{said.to_idf()}}}}}));
    return answers_.at(last_).instance(0);
  }

  mutable Mutex mutex_;
  const std::unique_ptr<Memory> memory_;
  const std::unique_ptr<Asker> asker_ ENGRAM_PT_GUARDED_BY(mutex_);
  const ltm::MemoryId answers_;
  const Options options_;
  Time last_ ENGRAM_GUARDED_BY(mutex_) = Time::min();
  std::atomic<size_t> answered_ = 0;
  /// It ends first, and waits for what runs.
  const std::unique_ptr<SkillProvider> provider_;
};

}  // namespace

Result<std::unique_ptr<AnswerSkill>> AnswerSkill::provide(const std::string& endpoint,
                                                          const Options& options) {
  ENGRAM_ASSIGN_OR_RETURN(auto memory, Memory::connect(endpoint, options.connect));
  ENGRAM_ASSIGN_OR_RETURN(
      ltm::MemoryId answers,
      ltm::MemoryId::from_names({"Speech", "Answers", kAnsweringProvider, kAnsweringSkill}));
  ENGRAM_RETURN_IF_ERROR(memory->declare(answers.parent().parent(), ::speech::Answer::idf_type()));
  ENGRAM_ASSIGN_OR_RETURN(auto asker, Asker::create(*memory, options.asker));
  ENGRAM_ASSIGN_OR_RETURN(auto provider,
                          SkillProvider::connect(endpoint, kAnsweringProvider, options.connect));
  auto live = std::make_unique<LiveAnswers>(std::move(memory), std::move(asker),
                                            std::move(provider), std::move(answers), options);
  ENGRAM_RETURN_IF_ERROR(live->register_skill());
  return std::unique_ptr<AnswerSkill>(std::move(live));
}

}  // namespace engram::speech
