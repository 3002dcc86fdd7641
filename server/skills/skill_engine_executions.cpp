// SPDX-License-Identifier: Apache-2.0
// What runs: from its start, which is written before its provider is told, to its only end.
#include <algorithm>

#include "ltm/core/log.h"
#include "ltm/idf/json.h"
#include "server/skills/skill_engine.h"

namespace engram::skills {

namespace {

constexpr Duration kWriteAgainAfter = std::chrono::milliseconds(200);
constexpr size_t kMaxReportBytes = size_t{16} << 20;
constexpr size_t kMaxReportLinks = 10'000;

/// What a provider reports, as far as it can be read.
void take_report(const SkillReport& report, ::skill::Event& event) {
  std::vector<std::string> problems;
  if (report.data_json.size() > kMaxReportBytes)
    problems.push_back(fmt::format("a result of {} bytes", report.data_json.size()));
  else if (const auto data = idf::from_json_text(report.data_json);
           !report.data_json.empty() && !data.ok())
    problems.push_back(fmt::format("a result: {}", data.status().message()));
  else
    event.result = report.data_json;
  for (const std::string& link : report.links) {
    auto id = ltm::MemoryId::parse(link);
    if (!id.ok() || event.results.size() >= kMaxReportLinks)
      problems.push_back(id.ok() ? "too many links" : id.status().message());
    else
      event.results.push_back(*std::move(id));
    if (problems.size() > 3) break;
  }
  if (!problems.empty())
    event.reason += fmt::format("{}(left out of what its provider said: {})",
                                event.reason.empty() ? "" : " ", fmt::join(problems, "; "));
}

::skill::Outcome outcome_said(SkillOutcome outcome) {
  switch (outcome) {
    case SkillOutcome::kSuccess:
      return ::skill::Outcome::SUCCESS;
    case SkillOutcome::kStop:
      return ::skill::Outcome::STOP;
    case SkillOutcome::kFailure:
      break;
  }
  return ::skill::Outcome::FAILURE;
}

}  // namespace

void SkillEngine::start(Attempt attempt) {
  KnownSkill& skill = skills_.at(attempt.name);
  const SkillName name = attempt.name;
  Execution execution;
  execution.executable = skill.executable;
  if (auto text = idf::to_json_text(attempt.parameters); text.ok())
    execution.parameters_json = *std::move(text);
  execution.inputs = links_of(skill.description.parameters, attempt.parameters);
  execution.attempt = std::move(attempt);
  ::skill::Event event = event_of(execution);
  event.stage = ::skill::Stage::STARTED;
  event.outcome = ::skill::Outcome::RUNNING;
  const auto id = records_.add(name, std::move(event));
  if (!id.ok()) {
    watched_.unwatch(execution.attempt.watched);
    give_up_start(execution, id.status());
    return;
  }
  execution.started = *id->time();
  const Provider& provider = providers_.at(name.provider);
  execution.session = provider.session;
  if (skill.description.timeout) execution.times_out = now() + *skill.description.timeout;
  skill.running.push_back(execution.started);
  ++counters_.started;
  const SkillStart start{id->to_string(), name.skill, execution.parameters_json,
                         execution.attempt.request.to_string()};
  executions_.emplace(start.execution, std::move(execution));
  provider.link->start(start);
}

void SkillEngine::give_up_start(Execution& execution, const Status& status) {
  const SkillName& name = execution.attempt.name;
  const std::string reason = fmt::format("its start could not be noted: {}", status.message());
  const Time started = records_.last_time(event_id(name));
  // A commit that failed may be there all the same: others then wait for an end.
  const auto noted = watched_.at(event_id(name), started);
  if (noted.ok() && !*noted) return refuse(name, execution.attempt.request, reason);
  execution.started = started;
  ::skill::Event event = event_of(execution);
  event.stage = ::skill::Stage::ENDED;
  event.outcome = ::skill::Outcome::FAILURE;
  event.reason = reason;
  ++counters_.started;
  ++counters_.ended;
  ++counters_.failed;
  write_end(name, event);
}

::skill::Event SkillEngine::event_of(const Execution& execution) const {
  ::skill::Event event;
  event.skill = execution.attempt.name.to_string();
  event.request = execution.attempt.request;
  event.executable = execution.executable;
  event.parameters = execution.parameters_json;
  event.inputs = execution.inputs;
  event.started = execution.started;
  event.stopped_by = execution.stopped_by;
  event.running = skills_.at(execution.attempt.name).running;
  if (execution.started != Time{})
    event.execution = event_id(execution.attempt.name).at(execution.started).instance(0);
  return event;
}

void SkillEngine::report(uint64_t session, const SkillReport& report) {
  const auto found = executions_.find(report.execution);
  // It has ended, or it is somebody else's.
  if (found == executions_.end() || found->second.session != session || found->second.end) return;
  Execution& execution = found->second;
  if (!report.is_end) {
    ::skill::Event event = event_of(execution);
    event.stage = ::skill::Stage::INTERMEDIATE;
    event.outcome = ::skill::Outcome::RUNNING;
    event.reason = report.reason;
    take_report(report, event);
    const auto written = records_.add(execution.attempt.name, std::move(event));
    if (!written.ok())
      log::warning("skills: a report of '{}' could not be noted: {}",
                   execution.attempt.name.to_string(), written.status().message());
    return;
  }
  execution.end = report;
  execution.ends_until = now() + skills_.at(execution.attempt.name).description.post_within;
  conclude(found);
  look_at_attempts();
}

void SkillEngine::conclude(Executions::iterator found) {
  Execution& execution = found->second;
  if (!execution.end) return;
  const SkillReport end = *execution.end;
  ::skill::Outcome outcome = outcome_said(end.outcome);
  std::string reason = end.reason;
  if (outcome != ::skill::Outcome::SUCCESS && execution.stops_until) {
    if (execution.is_late) outcome = ::skill::Outcome::FAILURE;
    reason = execution.stop_reason + (reason.empty() ? "" : "; " + reason);
  }
  if (outcome == ::skill::Outcome::SUCCESS && execution.attempt.post &&
      !execution.attempt.post->is_met(now())) {
    if (execution.ends_until > now()) return;
    std::vector<std::string> unmet;
    for (const Unmet& one : execution.attempt.post->unmet(now())) {
      unmet.push_back(one.to_string());
      if (one.where) execution.stopped_by.push_back(*one.where);
    }
    outcome = ::skill::Outcome::FAILURE;
    reason =
        fmt::format("it ended, but what must be so afterwards is not: {}", fmt::join(unmet, "; "));
  }
  finish(found, outcome, reason, end);
}

void SkillEngine::lose(Executions::iterator found, const std::string& reason) {
  if (!found->second.end) return finish(found, ::skill::Outcome::LOST, reason, {});
  // It waits for its condition afterwards, which is judged by what is so now.
  found->second.ends_until = now();
  conclude(found);
}

void SkillEngine::check_holds(Execution& execution, const std::string& id) {
  std::optional<ConditionState>& hold = execution.attempt.hold;
  if (!hold || execution.stops_until || hold->is_met(now())) return;
  std::vector<std::string> unmet;
  std::vector<ltm::MemoryId> by;
  for (const Unmet& one : hold->unmet(now())) {
    unmet.push_back(one.to_string());
    if (one.where) by.push_back(*one.where);
  }
  tell_to_stop(id, execution,
               fmt::format("its condition does not hold any more: {}", fmt::join(unmet, "; ")),
               std::move(by));
}

void SkillEngine::tell_to_stop(const std::string& id, Execution& execution,
                               const std::string& reason, std::vector<ltm::MemoryId> stopped_by) {
  if (execution.stops_until) return;
  const SkillName& name = execution.attempt.name;
  execution.stops_until = now() + skills_.at(name).description.stops_within;
  execution.stop_reason = reason;
  execution.stopped_by = std::move(stopped_by);
  if (const auto provider = providers_.find(name.provider); provider != providers_.end())
    provider->second.link->stop(id, reason);
}

void SkillEngine::finish(Executions::iterator found, ::skill::Outcome outcome,
                         const std::string& reason, const SkillReport& last) {
  // Taken out first: whatever happens next, it has ended.
  const auto node = executions_.extract(found);
  const Execution& execution = node.mapped();
  const SkillName& name = execution.attempt.name;
  std::erase(skills_.at(name).running, execution.started);
  watched_.unwatch(execution.attempt.watched);
  ::skill::Event event = event_of(execution);
  event.stage = ::skill::Stage::ENDED;
  event.outcome = outcome;
  event.reason = reason;
  take_report(last, event);
  ++counters_.ended;
  if (outcome == ::skill::Outcome::SUCCESS) ++counters_.succeeded;
  if (outcome == ::skill::Outcome::FAILURE) ++counters_.failed;
  if (outcome == ::skill::Outcome::STOP) ++counters_.stopped;
  if (outcome == ::skill::Outcome::LOST) ++counters_.lost;
  write_end(name, event);
}

void SkillEngine::write_end(const SkillName& name, const ::skill::Event& event) {
  Status status;
  // Ends are written in their order: each says what still runs.
  if (late_ends_.empty()) status = records_.add(name, event).status();
  if (status.ok() && late_ends_.empty()) return;
  if (!status.ok())
    log::warning("skills: an end of '{}' could not be noted, and will be again: {}",
                 name.to_string(), status.message());
  late_ends_.emplace_back(name, event);
  late_again_ = now() + kWriteAgainAfter;
}

void SkillEngine::write_late_ends() {
  while (!late_ends_.empty() && late_again_ <= now()) {
    const auto& [name, event] = late_ends_.front();
    if (!records_.add(name, event).ok()) {
      late_again_ = now() + kWriteAgainAfter;
      return;
    }
    late_ends_.pop_front();
  }
}

}  // namespace engram::skills
