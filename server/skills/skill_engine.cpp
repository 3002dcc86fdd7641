// SPDX-License-Identifier: Apache-2.0
#include "server/skills/skill_engine.h"

#include <algorithm>

#include "ltm/core/log.h"

namespace engram::skills {

SkillEngine::SkillEngine(SkillRecords& records, WatchedEntities& watched, Clock clock,
                         std::optional<Time> carries_out_since)
    : records_(records),
      watched_(watched),
      clock_(std::move(clock)),
      carries_out_since_(carries_out_since) {}

Status SkillEngine::recover() {
  ENGRAM_RETURN_IF_ERROR(watched_.watch({fmt::format("{}/{}", kSkillMemory, kRequestSegment)}));
  ENGRAM_RETURN_IF_ERROR(recover_skills());
  ENGRAM_RETURN_IF_ERROR(recover_executions());
  return recover_requests();
}

void SkillEngine::connect(uint64_t session, std::shared_ptr<ProviderLink> link,
                          const ProviderHello& hello) {
  Status status = check_name("provider", hello.provider);
  if (status.ok() && is_closing_) status = unavailable("the skill memory is closing");
  if (status.ok() && providers_.contains(hello.provider))
    status = already_exists(
        "provider '{}': another provider of this name is connected; two need two names",
        hello.provider);
  if (status.ok()) {
    status = introduce(hello);
    // Some of its skills may be there already, and nobody would carry them out.
    if (!status.ok()) take_away(hello.provider);
  }
  if (status.ok()) providers_.emplace(hello.provider, Provider{session, link});
  link->welcome(status);
  if (!status.ok()) return;
  for (auto& [name, skill] : skills_)
    if (name.provider == hello.provider && skill.when) on_condition(name, skill);
}

void SkillEngine::change(uint64_t session, const ProviderChange& change) {
  const auto provider = std::ranges::find_if(
      providers_, [&](const auto& one) { return one.second.session == session; });
  if (provider == providers_.end()) return;
  Status status = introduce({provider->first, change.added});
  if (status.ok()) status = remove(provider->first, change.removed);
  provider->second.link->welcome(status);
  for (auto& [name, skill] : skills_)
    if (name.provider == provider->first && skill.when) on_condition(name, skill);
}

void SkillEngine::disconnect(uint64_t session) {
  const auto provider = std::ranges::find_if(
      providers_, [&](const auto& one) { return one.second.session == session; });
  if (provider == providers_.end()) return;
  const std::string name = provider->first;
  providers_.erase(provider);
  std::vector<std::string> running;
  for (const auto& [id, execution] : executions_)
    if (execution.session == session) running.push_back(id);
  for (const std::string& id : running)
    lose(executions_.find(id), fmt::format("its provider '{}' went away", name));
  take_away(name);
  look_at_attempts();
}

void SkillEngine::on_snapshot(const ltm::Snapshot& snapshot) {
  const auto& names = snapshot.entity.names();
  if (names[0] == kSkillMemory && names[1] == kRequestSegment) on_request(snapshot);
  // What runs is looked at first: it may free what others wait for.
  std::vector<std::string> to_check;
  for (auto& [id, execution] : executions_) {
    const bool holds = execution.attempt.hold && execution.attempt.hold->offer(snapshot);
    const bool posts = execution.attempt.post && execution.attempt.post->offer(snapshot);
    if (holds || posts) to_check.push_back(id);
  }
  for (const std::string& id : to_check) {
    if (const auto found = executions_.find(id); found != executions_.end())
      check_holds(found->second, id);
    if (const auto found = executions_.find(id); found != executions_.end()) conclude(found);
  }
  bool is_awaited = false;
  for (Attempt& attempt : attempts_) {
    if (attempt.pre) is_awaited = attempt.pre->offer(snapshot) || is_awaited;
    if (attempt.hold) is_awaited = attempt.hold->offer(snapshot) || is_awaited;
    if (attempt.post) attempt.post->offer(snapshot);
  }
  if (is_awaited) look_at_attempts();
  for (auto& [name, skill] : skills_)
    if (skill.when && skill.when->offer(snapshot)) on_condition(name, skill);
}

void SkillEngine::on_gap() {
  // Subscriptions that were interrupted are in place again by themselves; what came in between is
  // in the memory: requests, and what is the case now.
  Status status = recover_requests();
  const auto look = [&](std::optional<ConditionState>& state) {
    if (state && status.ok()) status = seed(*state);
  };
  for (auto& [id, execution] : executions_) {
    look(execution.attempt.hold);
    look(execution.attempt.post);
  }
  for (Attempt& attempt : attempts_) {
    look(attempt.pre);
    look(attempt.hold);
    look(attempt.post);
  }
  for (auto& [name, skill] : skills_) look(skill.when);
  if (!status.ok()) log::warning("skills: something may have been missed: {}", status.message());
  on_time();
}

void SkillEngine::on_time() {
  write_late_ends();
  std::vector<std::string> ids;
  for (const auto& [id, execution] : executions_) ids.push_back(id);
  for (const std::string& id : ids) {
    auto found = executions_.find(id);
    if (found == executions_.end()) continue;
    Execution& execution = found->second;
    if (!execution.end) check_holds(execution, id);
    if (execution.times_out && *execution.times_out <= now() && !execution.stops_until &&
        !execution.end) {
      execution.is_late = true;
      tell_to_stop(
          id, execution,
          fmt::format("it took longer than {}",
                      engram::to_string(*skills_.at(execution.attempt.name).description.timeout)),
          {});
    }
    if (execution.stops_until && *execution.stops_until <= now() && !execution.end) {
      finish(found, ::skill::Outcome::FAILURE,
             fmt::format("its provider did not stop it in time ({})", execution.stop_reason), {});
      continue;
    }
    conclude(found);
  }
  look_at_attempts();
  for (auto& [name, skill] : skills_)
    if (skill.when) on_condition(name, skill);
}

std::optional<Time> SkillEngine::next_time() const {
  std::optional<Time> next;
  const auto consider = [&](std::optional<Time> time) {
    if (time && (!next || *time < *next)) next = time;
  };
  const Time at = now();
  if (!late_ends_.empty()) consider(late_again_);
  for (const auto& [id, execution] : executions_) {
    if (execution.end) {
      consider(execution.ends_until);
      if (execution.attempt.post) consider(execution.attempt.post->next_change(at));
      continue;
    }
    consider(execution.stops_until ? execution.stops_until : execution.times_out);
    if (execution.attempt.hold && !execution.stops_until)
      consider(execution.attempt.hold->next_change(at));
  }
  for (const Attempt& attempt : attempts_) {
    consider(attempt.until);
    if (attempt.pre) consider(attempt.pre->next_change(at));
    if (attempt.hold) consider(attempt.hold->next_change(at));
  }
  for (const auto& [name, skill] : skills_)
    if (skill.when) consider(skill.when->next_change(at));
  return next;
}

void SkillEngine::shut_down() {
  is_closing_ = true;
  std::vector<Attempt> waiting = std::move(attempts_);
  attempts_.clear();
  for (const Attempt& attempt : waiting)
    refuse(attempt.name, attempt.request, "the skill memory closed while it waited");
  for (auto& [id, execution] : executions_)
    if (!execution.end) tell_to_stop(id, execution, "the skill memory is closing", {});
}

void SkillEngine::lose_all(const std::string& reason) {
  while (!executions_.empty()) lose(executions_.begin(), reason);
  for (const auto& [name, provider] : providers_) take_away(name);
}

SkillCounters SkillEngine::counters() const {
  SkillCounters counters = counters_;
  counters.running = executions_.size();
  counters.waiting = attempts_.size();
  return counters;
}

}  // namespace engram::skills
