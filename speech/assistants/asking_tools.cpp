// SPDX-License-Identifier: Apache-2.0
#include "speech/assistants/asking_tools.h"

#include <utility>

#include "speech/assistants/tool_arguments.h"
#include "speech/telling/tell_period.h"

namespace engram::speech {

namespace {

constexpr size_t kMaxToldExecutions = 200;

Result<ToolAnswer> ask(Asker& asker, const ToolJson& json) {
  ToolArguments arguments(json);
  ENGRAM_ASSIGN_OR_RETURN(const std::string question, arguments.text("question"));
  ENGRAM_ASSIGN_OR_RETURN(const auto now, arguments.time("now"));
  ENGRAM_RETURN_IF_ERROR(arguments.finish());
  ENGRAM_RETURN_IF_ERROR(asker.refresh());
  ENGRAM_ASSIGN_OR_RETURN(const Answer answer,
                          asker.ask(question, now.value_or(asker.facts().last_moment())));
  return ToolAnswer{answer.to_json()};
}

ToolJson execution_json(const KnownFacts& facts, const Execution& execution) {
  ToolJson json{{"id", execution.start_id.to_string()},
                {"skill", execution.skill},
                {"from", to_string(execution.started)}};
  if (execution.ended) json["until"] = to_string(*execution.ended);
  json["outcome"] = std::string(ltm::name_of(execution.outcome));
  if (!execution.reason.empty()) json["reason"] = execution.reason;
  if (execution.thing) json["thing"] = facts.world().spoken(*execution.thing);
  if (execution.place) json["place"] = facts.world().spoken(*execution.place);
  return json;
}

Result<ToolAnswer> timeline(Asker& asker, const ToolJson& json) {
  ToolArguments arguments(json);
  ENGRAM_ASSIGN_OR_RETURN(const auto from, arguments.time("from"));
  ENGRAM_ASSIGN_OR_RETURN(const auto until, arguments.time("until"));
  ENGRAM_RETURN_IF_ERROR(arguments.finish());
  ENGRAM_RETURN_IF_ERROR(asker.refresh());
  KnownFacts& facts = asker.facts();
  const Period period{from.value_or(facts.first_moment()), until.value_or(facts.last_moment())};
  if (period.to < period.from)
    return invalid_argument("argument 'until': found {}, needs a time at or after 'from', {}",
                            to_string(period.to), to_string(period.from));
  ENGRAM_ASSIGN_OR_RETURN(const auto told,
                          tell_period(facts, period, facts.last_moment(), asker.zone()));
  ToolJson sentences = ToolJson::array();
  for (const NarrationSentence& one : told) {
    ToolJson links = ToolJson::array();
    for (const ltm::MemoryId& id : one.links) links.push_back(id.to_string());
    sentences.push_back({{"text", one.text}, {"evidence", std::move(links)}});
  }
  ToolJson executions = ToolJson::array();
  size_t left_out = 0;
  for (const Execution& execution : facts.executions()) {
    if (execution.started < period.from || execution.started > period.to) continue;
    if (executions.size() < kMaxToldExecutions)
      executions.push_back(execution_json(facts, execution));
    else
      ++left_out;
  }
  return ToolAnswer{{{"told", std::move(sentences)},
                     {"executions", std::move(executions)},
                     {"left_out", left_out}}};
}

}  // namespace

std::vector<MemoryTool> asking_tools(std::shared_ptr<Asker> asker) {
  const char* const time_text = "'2022-02-18 13:06:56', RFC 3339, or integer nanoseconds, UTC";
  const ToolJson time{{"type", "string"}, {"description", time_text}};
  return {
      {"ask",
       "Ask in English what the robot did and why",
       "Answers a question in English about what the robot did, saw, held and was told: what, "
       "when, "
       "where, who, why, how long, how often, what went wrong. The answer names the snapshots that "
       "show it; value.kind is 'unknown' where the memory does not know.",
       {{"type", "object"},
        {"properties",
         {{"question", {{"type", "string"}, {"description", "A question in English"}}},
          {"now", time}}},
        {"required", ToolJson::array({"question"})},
        {"additionalProperties", false}},
       [asker](const ToolJson& arguments) { return ask(*asker, arguments); }},
      {"timeline",
       "What was done in a time",
       "Tells in sentences what the robot was asked for, did and failed at, and lists what it "
       "executed, in the order of time. Without times: all of its life.",
       {{"type", "object"},
        {"properties", {{"from", time}, {"until", time}}},
        {"required", ToolJson::array()},
        {"additionalProperties", false}},
       [asker](const ToolJson& arguments) { return timeline(*asker, arguments); }},
  };
}

}  // namespace engram::speech
