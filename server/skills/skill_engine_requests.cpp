// SPDX-License-Identifier: Apache-2.0
// Who wants what of skills: whether it may be done, now or later.
#include <algorithm>

#include "ltm/core/log.h"
#include "ltm/idf/json.h"
#include "server/skills/skill_engine.h"

namespace engram::skills {

namespace {

constexpr size_t kMaxAnswered = 100'000;
constexpr size_t kMaxWaiting = 10'000;
/// Who asks for what conditions start.
constexpr std::string_view kConditions = "conditions";

/// Whether two resources are the same, or one is a part of the other: "arm" and "arm/left".
bool is_shared(const std::string& a, const std::string& b) {
  const std::string& shorter = a.size() < b.size() ? a : b;
  const std::string& longer = a.size() < b.size() ? b : a;
  return longer.starts_with(shorter) &&
         (longer.size() == shorter.size() || longer[shorter.size()] == '/');
}

/// "arm/$hand" with the value of the parameter.
Result<std::string> resource_with(const std::string& text, const idf::Data& parameters) {
  const size_t at = text.find('$');
  if (at == std::string::npos) return text;
  const std::string parameter = text.substr(at + 1);
  const idf::Data* value = parameters.at(idf::join_path("", parameter));
  const auto* word = value == nullptr ? nullptr : value->get_if<std::string>();
  if (word == nullptr)
    return invalid_argument("resource '{}': parameter '{}' is no text", text, parameter);
  return text.substr(0, at) + *word;
}

void add_unmet(const ConditionState& state, Time now, ::skill::Refusal& why) {
  for (const Unmet& unmet : state.unmet(now)) {
    why.unmet.push_back(unmet.to_string());
    if (unmet.where) why.found.push_back(*unmet.where);
  }
}

}  // namespace

bool SkillEngine::mark_answered(const ltm::MemoryId& request) {
  std::string text = request.to_string();
  if (!answered_.insert(text).second) return false;
  answered_order_.push_back(std::move(text));
  if (answered_order_.size() > kMaxAnswered) {
    answered_.erase(answered_order_.front());
    answered_order_.pop_front();
  }
  return true;
}

void SkillEngine::on_request(const ltm::Snapshot& snapshot) {
  const ltm::MemoryId id = snapshot.id().instance(0);
  if (is_closing_ || !mark_answered(id)) return;
  records_.note(snapshot.entity, snapshot.time);
  const SkillName asked{snapshot.entity.names()[2], snapshot.entity.names()[3]};
  const auto wanted = ::skill::ExecutionRequest::from_idf(snapshot.instances.front().data);
  if (!wanted.ok()) return refuse(asked, id, wanted.status().message());
  const auto name = find(wanted->skill);
  if (!name.ok()) {
    ++counters_.requests;
    return refuse(asked, id, name.status().message());
  }
  switch (wanted->wish) {
    case ::skill::Wish::RUN:
      return request_run(*name, id, *wanted);
    case ::skill::Wish::STOP:
      return request_stop(*name, id, *wanted);
    case ::skill::Wish::ENABLE:
      return set_enabled(*name, true);
    case ::skill::Wish::DISABLE:
      return set_enabled(*name, false);
  }
}

void SkillEngine::request_run(const SkillName& name, const ltm::MemoryId& request,
                              const ::skill::ExecutionRequest& wanted) {
  ++counters_.requests;
  auto attempt = prepare(name, request, wanted);
  if (!attempt.ok()) return refuse(name, request, attempt.status().message());
  ::skill::Refusal why;
  if (try_start(*attempt, why)) return;
  if (wanted.wait > 0 && attempts_.size() < kMaxWaiting) {
    attempts_.push_back(*std::move(attempt));
    return;
  }
  watched_.unwatch(attempt->watched);
  refuse(name, request, std::move(why));
}

void SkillEngine::request_stop(const SkillName& name, const ltm::MemoryId& request,
                               const ::skill::ExecutionRequest& wanted) {
  bool is_found = false;
  const std::string only = wanted.execution ? wanted.execution->to_string() : "";
  const auto is_meant = [&](const Attempt& attempt, const std::string& id) {
    return attempt.name == name &&
           (only.empty() || only == id || only == attempt.request.to_string());
  };
  for (auto& [id, execution] : executions_) {
    if (!is_meant(execution.attempt, id)) continue;
    is_found = true;
    tell_to_stop(id, execution, "somebody asked to stop it", {request});
  }
  std::vector<Attempt> waiting;
  std::swap(waiting, attempts_);
  for (Attempt& attempt : waiting) {
    if (!is_meant(attempt, "")) {
      attempts_.push_back(std::move(attempt));
      continue;
    }
    is_found = true;
    watched_.unwatch(attempt.watched);
    refuse(name, attempt.request, "somebody asked to stop it while it waited");
  }
  if (!is_found)
    refuse(name, request,
           only.empty() ? fmt::format("skill '{}': nothing of it runs or waits", name.to_string())
                        : fmt::format("'{}' neither runs nor waits", only));
}

Result<SkillEngine::Attempt> SkillEngine::prepare(const SkillName& name,
                                                  const ltm::MemoryId& request,
                                                  const ::skill::ExecutionRequest& wanted) {
  const KnownSkill& known = skills_.at(name);
  const SkillDescription& skill = known.description;
  if (!wanted.version.empty() && wanted.version != skill.version)
    return failed_precondition("skill '{}': has version {}, but version {} was asked for",
                               name.to_string(), skill.version, wanted.version);
  Attempt attempt{.name = name, .request = request};
  auto given = idf::from_json_text(wanted.parameters.empty() ? "{}" : wanted.parameters);
  if (!given.ok()) return given.status().with_context("parameters");
  ENGRAM_ASSIGN_OR_RETURN(attempt.parameters, skill.parameters.fit(*given));
  for (const std::string& resource : skill.resources) {
    ENGRAM_ASSIGN_OR_RETURN(std::string text, resource_with(resource, attempt.parameters));
    attempt.resources.push_back(std::move(text));
  }
  const auto wait = duration_from_seconds(wanted.wait);
  if (!wait.ok()) return wait.status().with_context("wait");
  constexpr Duration kMaxWait = std::chrono::hours(24);
  attempt.until = now() + std::min(*wait, kMaxWait);
  ENGRAM_RETURN_IF_ERROR(prepare_conditions(skill, attempt));
  return attempt;
}

Status SkillEngine::prepare_conditions(const SkillDescription& skill, Attempt& attempt) {
  for (const auto& [condition, state] : {std::pair{&skill.pre, &attempt.pre},
                                         {&skill.hold, &attempt.hold},
                                         {&skill.post, &attempt.post}}) {
    if (condition->is_empty()) continue;
    ENGRAM_ASSIGN_OR_RETURN(const Condition filled,
                            with_parameters(*condition, attempt.parameters));
    ENGRAM_ASSIGN_OR_RETURN(*state, ConditionState::create(filled));
    for (std::string& pattern : (*state)->patterns()) attempt.watched.push_back(std::move(pattern));
  }
  ENGRAM_RETURN_IF_ERROR(watched_.watch(attempt.watched));
  for (std::optional<ConditionState>* state : {&attempt.pre, &attempt.hold, &attempt.post}) {
    if (!*state) continue;
    if (const Status status = seed(**state); !status.ok()) {
      watched_.unwatch(attempt.watched);
      return status;
    }
  }
  return {};
}

Status SkillEngine::seed(ConditionState& state) {
  for (const std::string& pattern : state.patterns()) {
    ENGRAM_ASSIGN_OR_RETURN(const auto snapshots, watched_.latest(pattern));
    for (const ltm::Snapshot& snapshot : snapshots) state.seed(snapshot);
  }
  return {};
}

bool SkillEngine::try_start(Attempt& attempt, ::skill::Refusal& why) {
  const KnownSkill& skill = skills_.at(attempt.name);
  const std::string name = attempt.name.to_string();
  if (!skill.is_enabled) {
    why.reason = fmt::format("skill '{}' is disabled", name);
  } else if (!skill.is_available) {
    why.reason =
        fmt::format("skill '{}': its provider '{}' is not there", name, attempt.name.provider);
  } else if (static_cast<int>(skill.running.size()) >= skill.description.max_running) {
    why.reason = fmt::format("skill '{}': {} of it run, and at most {} may", name,
                             skill.running.size(), skill.description.max_running);
  }
  if (!why.reason.empty()) return false;
  for (const auto& [id, other] : executions_)
    for (const std::string& resource : attempt.resources)
      for (const std::string& used : other.attempt.resources)
        if (is_shared(resource, used)) {
          why.reason =
              fmt::format("'{}' is used by '{}'", resource, other.attempt.name.to_string());
          why.found.push_back(*ltm::MemoryId::parse(id));
          return false;
        }
  for (std::optional<ConditionState>* state : {&attempt.pre, &attempt.hold}) {
    if (!*state || (*state)->is_met(now())) continue;
    add_unmet(**state, now(), why);
    why.reason = fmt::format("its condition is not met: {}", fmt::join(why.unmet, "; "));
    return false;
  }
  start(std::move(attempt));
  return true;
}

void SkillEngine::refuse(const SkillName& name, const ltm::MemoryId& request,
                         const std::string& reason) {
  ::skill::Refusal refusal;
  refusal.reason = reason;
  refuse(name, request, std::move(refusal));
}

void SkillEngine::refuse(const SkillName& name, const ltm::MemoryId& request,
                         ::skill::Refusal refusal) {
  refusal.skill = name.to_string();
  refusal.request = request;
  if (const auto known = skills_.find(name);
      known != skills_.end() && known->second.executable.depth() > 0)
    refusal.executable = known->second.executable;
  ++counters_.refused;
  const auto written = records_.add(name, refusal);
  if (!written.ok())
    log::warning("skills: '{}' was refused ({}), which could not be noted: {}", name.to_string(),
                 refusal.reason, written.status().message());
}

void SkillEngine::look_at_attempts() {
  if (attempts_.empty() || is_closing_) return;
  std::vector<Attempt> waiting;
  std::swap(waiting, attempts_);
  for (Attempt& attempt : waiting) {
    ::skill::Refusal why;
    if (try_start(attempt, why)) continue;
    if (attempt.until > now()) {
      attempts_.push_back(std::move(attempt));
      continue;
    }
    watched_.unwatch(attempt.watched);
    refuse(attempt.name, attempt.request, std::move(why));
  }
}

void SkillEngine::on_condition(const SkillName& name, KnownSkill& skill) {
  const bool was_met = skill.was_met;
  const bool is_met = skill.when->is_met(now());
  const std::vector<ltm::MemoryId> causes = skill.when->causes();
  const auto bound = skill.when->bound();
  // What was met by something new is not met any more now.
  skill.was_met = is_met && skill.when->is_met(now());
  if (!is_met || was_met || !skill.is_enabled || !skill.is_available || is_closing_) return;
  ::skill::ExecutionRequest request;
  request.skill = name.to_string();
  request.causes = causes;
  idf::Dict parameters;
  for (const auto& [parameter, link] : bound) parameters.set(parameter, link.to_string());
  auto text = idf::to_json_text(idf::Data(std::move(parameters)));
  request.parameters = text.ok() ? *std::move(text) : "{}";
  const auto id = records_.add_request(kConditions, name, request);
  if (!id.ok()) {
    log::warning("skills: '{}' was not started: {}", name.to_string(), id.status().message());
    return;
  }
  if (mark_answered(*id)) request_run(name, *id, request);
}

}  // namespace engram::skills
