// SPDX-License-Identifier: Apache-2.0
#include "server/skills/skill_call.h"

#include <algorithm>

#include "ltm/core/mutex.h"
#include "ltm/idf/json.h"
#include "ltm/memory/answered_snapshots.h"
#include "ltm/skills/skill_ids.h"
#include "server/skills/skill_description.h"

namespace engram::skills {

namespace {

/// What is told of one request.
class AwaitedEnd {
 public:
  AwaitedEnd(std::string request, const std::function<void(const ::skill::Event&)>& on_event)
      : request_(std::move(request)), on_event_(on_event) {}

  void take(const ltm::Snapshot& snapshot) {
    if (snapshot.instances.empty()) return;
    const idf::Data& data = snapshot.instances.front().data;
    const ltm::MemoryId id = snapshot.id().instance(0);
    if (snapshot.entity.names()[1] == kRefusalSegment) {
      if (auto refusal = ::skill::Refusal::from_idf(data); refusal.ok())
        take(id, *std::move(refusal));
    } else if (auto event = ::skill::Event::from_idf(data); event.ok()) {
      take(id, *std::move(event));
    }
  }

  SubscriptionHandlers handlers() {
    const auto miss = [this] {
      const MutexLock lock(mutex_);
      has_missed_ = true;
    };
    return {[this](const std::vector<ToldSnapshot>& told) {
              for (const ToldSnapshot& one : told)
                if (one.has_data) take(one.snapshot);
            },
            [miss](uint64_t /*lost*/) { miss(); }, [miss](const Status& /*status*/) { miss(); }};
  }

  /// Waits for the end.
  void wait(Duration time) {
    const MutexLock lock(mutex_);
    changed_.wait_for(mutex_, time, [&]() ENGRAM_REQUIRES(mutex_) { return result_.has_value(); });
  }
  std::optional<SkillResult> result() {
    const MutexLock lock(mutex_);
    return result_;
  }
  bool has_started() {
    const MutexLock lock(mutex_);
    return has_started_;
  }
  /// Whether something was not told, so that the memory has to be asked.
  bool has_missed() {
    const MutexLock lock(mutex_);
    return has_missed_;
  }

 private:
  void take(const ltm::MemoryId& id, ::skill::Event event) {
    if (event.request.to_string() != request_) return;
    if (on_event_) on_event_(event);
    const MutexLock lock(mutex_);
    has_started_ = true;
    if (event.stage == ::skill::Stage::ENDED && !result_) {
      result_.emplace();
      result_->end = std::move(event);
      result_->end_id = id;
    }
    changed_.notify_all();
  }
  void take(const ltm::MemoryId& id, ::skill::Refusal refusal) {
    if (refusal.request.to_string() != request_) return;
    const MutexLock lock(mutex_);
    if (!result_) {
      result_.emplace();
      result_->is_refused = true;
      result_->refusal = std::move(refusal);
      result_->end_id = id;
    }
    changed_.notify_all();
  }

  const std::string request_;
  const std::function<void(const ::skill::Event&)>& on_event_;
  Mutex mutex_;
  ConditionVariable changed_;
  bool has_started_ ENGRAM_GUARDED_BY(mutex_) = false;
  bool has_missed_ ENGRAM_GUARDED_BY(mutex_) = false;
  std::optional<SkillResult> result_ ENGRAM_GUARDED_BY(mutex_);
};

/// The entity of a request: the skill without its provider, as far as that is a name.
Result<ltm::MemoryId> entity_of(const std::string& skill, const std::string& requester) {
  const std::string name =
      skill.substr(skill.find('/') == std::string::npos ? 0 : skill.find('/') + 1);
  ENGRAM_RETURN_IF_ERROR(check_name("skill", name));
  ENGRAM_RETURN_IF_ERROR(check_name("requester", requester));
  return request_id(requester, name);
}

/// Tells it what the memory has of the last hour.
Status look_up(Memory& memory, AwaitedEnd& awaited) {
  const auto answer = memory.query("Skill/Event @ last:1h ; Skill/Refusal @ last:1h");
  // While the server is away it is asked again later.
  if (!answer.ok() && answer.status().code() != StatusCode::kNotFound &&
      answer.status().code() != StatusCode::kUnavailable)
    return answer.status();
  if (answer.ok())
    for (const ltm::Snapshot& snapshot : ltm::answered_snapshots(*answer)) awaited.take(snapshot);
  return {};
}

ltm::Commit commit_of(const ltm::MemoryId& entity, Time time,
                      const ::skill::ExecutionRequest& request, const std::string& requester) {
  return {{{entity,
            time,
            {{request.to_idf(), {.created = time, .sent = time, .provider = requester}}}}}};
}

/// The newest value of an entity of the skill memory.
template <typename T>
Result<std::optional<T>> newest(Memory& memory, const ltm::MemoryId& entity) {
  const auto answer = memory.query(ltm::Query::of_entity(entity, ltm::select::Latest{}), "");
  if (!answer.ok() && answer.status().code() != StatusCode::kNotFound) return answer.status();
  const ltm::EntityResult* found = answer.ok() ? answer->find_entity(entity) : nullptr;
  if (found == nullptr || found->snapshots.empty() || found->snapshots.back().instances.empty())
    return std::optional<T>();
  ENGRAM_ASSIGN_OR_RETURN(T value, T::from_idf(found->snapshots.back().instances.front().data));
  return std::optional<T>(std::move(value));
}

Result<ConditionNow> condition_now(Memory& memory, std::string name, const Condition& condition) {
  ENGRAM_ASSIGN_OR_RETURN(ConditionState state, ConditionState::create(condition));
  for (const std::string& pattern : state.patterns()) {
    const auto answer = memory.query(pattern + " @ latest");
    if (!answer.ok() && answer.status().code() != StatusCode::kNotFound) return answer.status();
    if (!answer.ok()) continue;
    for (const ltm::Snapshot& snapshot : ltm::answered_snapshots(*answer)) state.seed(snapshot);
  }
  const Time now = system_now();
  ConditionNow told{std::move(name), to_string(condition), state.is_met(now), {}};
  if (!told.is_met) told.unmet = state.unmet(now);
  return told;
}

}  // namespace

Result<SkillResult> run_skill(Memory& memory, const SkillRequest& request,
                              const std::function<void(const ::skill::Event&)>& on_event,
                              const std::stop_token& stop, Duration answer_within) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId entity, entity_of(request.skill, request.requester));
  const Time now = system_now();
  const ltm::MemoryId id = entity.at(now).instance(0);
  AwaitedEnd awaited(id.to_string(), on_event);
  ::skill::ExecutionRequest value;
  value.skill = request.skill;
  value.parameters = request.parameters_json;
  value.wait = to_seconds(request.wait);
  value.version = request.version;
  value.causes = request.causes;
  ENGRAM_ASSIGN_OR_RETURN(
      const auto subscription,
      memory.subscribe({.names = {"Skill/Event", "Skill/Refusal"}, .with_data = true},
                       awaited.handlers()));
  ENGRAM_RETURN_IF_ERROR(memory.commit(commit_of(entity, now, value, request.requester)));
  const SteadyTime give_up = steady_now() + answer_within + request.wait;
  bool is_stopped = false;
  SteadyTime look_again{};
  while (true) {
    constexpr auto kLookEvery = std::chrono::milliseconds(50);
    constexpr auto kAskEvery = std::chrono::seconds(1);
    awaited.wait(kLookEvery);
    // A server that was away tells nobody what came meanwhile, and nobody says when the
    // subscription is in place again.
    if (awaited.has_missed() && steady_now() > look_again) {
      ENGRAM_RETURN_IF_ERROR(look_up(memory, awaited));
      look_again = steady_now() + kAskEvery;
    }
    if (auto result = awaited.result()) {
      result->request = id;
      return *std::move(result);
    }
    if (stop.stop_requested() && !is_stopped) {
      is_stopped = true;
      ENGRAM_RETURN_IF_ERROR(
          ask_skill(memory, request.skill, ::skill::Wish::STOP, request.requester, id).status());
    }
    if (!awaited.has_started() && steady_now() > give_up)
      return unavailable(
          "skill '{}': no answer within {}: does a server with the memory Skill run?",
          request.skill, engram::to_string(answer_within + request.wait));
  }
}

Result<ltm::MemoryId> ask_skill(Memory& memory, const std::string& skill, ::skill::Wish wish,
                                const std::string& requester,
                                const std::optional<ltm::MemoryId>& execution) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId entity, entity_of(skill, requester));
  ::skill::ExecutionRequest value;
  value.skill = skill;
  value.wish = wish;
  value.parameters = "{}";
  value.execution = execution;
  const Time now = system_now();
  ENGRAM_RETURN_IF_ERROR(memory.commit(commit_of(entity, now, value, requester)));
  return entity.at(now).instance(0);
}

Result<std::vector<std::pair<ltm::MemoryId, ::skill::Executable>>> list_skills(Memory& memory) {
  std::vector<std::pair<ltm::MemoryId, ::skill::Executable>> skills;
  const auto answer = memory.query(fmt::format("{}/Executable @ latest", kSkillMemory));
  if (!answer.ok() && answer.status().code() == StatusCode::kNotFound) return skills;
  if (!answer.ok()) return answer.status();
  for (const ltm::EntityResult* entity : answer->entities()) {
    if (entity->snapshots.empty() || entity->snapshots.back().instances.empty()) continue;
    const ltm::SnapshotResult& last = entity->snapshots.back();
    ENGRAM_ASSIGN_OR_RETURN(auto value, ::skill::Executable::from_idf(last.instances.front().data));
    skills.emplace_back(entity->id.at(last.time).instance(0), std::move(value));
  }
  return skills;
}

Result<SkillNow> explain_skill(Memory& memory, const std::string& skill,
                               const std::optional<std::string>& parameters_json) {
  ENGRAM_ASSIGN_OR_RETURN(const auto all, list_skills(memory));
  std::vector<std::pair<ltm::MemoryId, ::skill::Executable>> found;
  std::vector<std::string> words;
  for (const auto& one : all) {
    const SkillName name{one.first.names()[2], one.first.names()[3]};
    if (name.to_string() == skill || name.skill == skill) found.push_back(one);
    words.push_back(name.to_string());
    words.push_back(name.skill);
  }
  if (found.empty()) {
    const auto close = closest_word(skill, words);
    return not_found("skill '{}': there is no such skill{}", skill,
                     close ? fmt::format(", did you mean '{}'?", *close) : "");
  }
  if (found.size() > 1)
    return invalid_argument("skill '{}': {} providers have it, needs PROVIDER/SKILL", skill,
                            found.size());
  SkillNow now{.id = found.front().first, .executable = found.front().second};
  const SkillName name{now.id.names()[2], now.id.names()[3]};
  ENGRAM_ASSIGN_OR_RETURN(now.last_event, newest<::skill::Event>(memory, event_id(name)));
  ENGRAM_ASSIGN_OR_RETURN(now.last_refusal, newest<::skill::Refusal>(memory, refusal_id(name)));
  ENGRAM_ASSIGN_OR_RETURN(const SkillDescription description,
                          SkillDescription::parse(now.executable.description));
  std::optional<idf::Data> parameters;
  if (parameters_json) {
    ENGRAM_ASSIGN_OR_RETURN(const idf::Data given, idf::from_json_text(*parameters_json));
    ENGRAM_ASSIGN_OR_RETURN(parameters, description.parameters.fit(given));
  }
  for (const auto& [kind, condition] : {std::pair{"when", &description.when},
                                        {"pre", &description.pre},
                                        {"hold", &description.hold},
                                        {"post", &description.post}}) {
    if (condition->is_empty()) continue;
    if (!parameters_in(*condition).empty() && !parameters) {
      now.needs_parameters.emplace_back(kind);
      continue;
    }
    ENGRAM_ASSIGN_OR_RETURN(
        const Condition filled,
        with_parameters(*condition, parameters.value_or(idf::Data(idf::Dict()))));
    ENGRAM_ASSIGN_OR_RETURN(ConditionNow told, condition_now(memory, kind, filled));
    now.conditions.push_back(std::move(told));
  }
  return now;
}

}  // namespace engram::skills
