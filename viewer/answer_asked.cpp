// SPDX-License-Identifier: Apache-2.0
#include "speech/language/asker.h"
#include "speech/telling/tell_period.h"
#include "viewer/view_answers.h"

namespace engram::viewer {

namespace {

using AskedJson = nlohmann::ordered_json;

/// Longer ones are no questions.
constexpr size_t kMaxQuestion = 10'000;
constexpr size_t kMaxSentences = 12;

}  // namespace

ViewAnswer answer_ask(ViewedMemory& viewed, const RequestTarget& target) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string question, target.text("q"));
  if (question.size() > kMaxQuestion)
    return invalid_argument("parameter 'q': has {} bytes, needs at most {}", question.size(),
                            kMaxQuestion);
  std::optional<Time> now;
  if (target.find("now")) {
    ENGRAM_ASSIGN_OR_RETURN(now, target.time("now"));
  }
  AskedJson json;
  ENGRAM_RETURN_IF_ERROR(viewed.with_asker([&](speech::Asker& asker) -> Status {
    ENGRAM_ASSIGN_OR_RETURN(const speech::Answer answer,
                            asker.ask(question, now.value_or(asker.facts().last_moment())));
    json = answer.to_json();
    return {};
  }));
  return bounded_json(json);
}

ViewAnswer answer_tell(ViewedMemory& viewed, const RequestTarget& target) {
  ENGRAM_ASSIGN_OR_RETURN(const Time from, target.time("from"));
  ENGRAM_ASSIGN_OR_RETURN(const Time until, target.time("until"));
  if (until < from)
    return invalid_argument("parameter 'until': found {}, needs a time at or after 'from', {}",
                            to_string(until), to_string(from));
  AskedJson sentences = AskedJson::array();
  ENGRAM_RETURN_IF_ERROR(viewed.with_asker([&](speech::Asker& asker) -> Status {
    ENGRAM_ASSIGN_OR_RETURN(const auto told, speech::tell_period(asker.facts(), {from, until},
                                                                 asker.facts().last_moment(),
                                                                 asker.zone(), kMaxSentences));
    for (const speech::NarrationSentence& one : told) {
      AskedJson links = AskedJson::array();
      for (const ltm::MemoryId& id : one.links) links.push_back(id.to_string());
      sentences.push_back(
          {{"level", speech::name_of(one.level)}, {"text", one.text}, {"links", std::move(links)}});
    }
    return {};
  }));
  return bounded_json({{"sentences", std::move(sentences)}});
}

}  // namespace engram::viewer
