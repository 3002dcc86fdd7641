// SPDX-License-Identifier: Apache-2.0
// Which skills there are: what was known before, what providers bring, what people switch off.
#include <algorithm>

#include "ltm/core/log.h"
#include "server/skills/skill_engine.h"

namespace engram::skills {

namespace {

/// How far back requests without an answer are looked for.
constexpr std::string_view kLookBack = "last:1h";

SkillName name_in(const ltm::MemoryId& entity) {
  return {entity.names()[2], entity.names()[3]};
}

std::string segment_text(std::string_view segment) {
  return fmt::format("{}/{}", kSkillMemory, segment);
}

}  // namespace

Status SkillEngine::recover_skills() {
  ENGRAM_ASSIGN_OR_RETURN(const auto known, watched_.latest(segment_text(kExecutableSegment)));
  for (const ltm::Snapshot& snapshot : known) {
    records_.note(snapshot.entity, snapshot.time);
    if (snapshot.instances.empty()) continue;
    auto value = ::skill::Executable::from_idf(snapshot.instances.front().data);
    auto description = value.ok() ? SkillDescription::parse(value->description)
                                  : Result<SkillDescription>(value.status());
    // A skill that cannot be read must not keep all others from being there.
    if (!description.ok()) {
      log::warning("skills: '{}' is left out: {}", snapshot.entity.printable(),
                   description.status().message());
      continue;
    }
    const SkillName name = name_in(snapshot.entity);
    if (description->name != name.skill) {
      log::warning("skills: '{}' is left out: its description is of '{}'",
                   snapshot.entity.printable(), description->name);
      continue;
    }
    const bool is_prior = snapshot.instances.front().metadata.provider == "prior";
    ENGRAM_RETURN_IF_ERROR(take_skill(name, *std::move(description), is_prior));
    KnownSkill& skill = skills_.at(name);
    skill.executable = snapshot.id().instance(0);
    skill.is_enabled = value->is_enabled.value_or(true);
    // Its provider is not connected to this process yet.
    if (value->is_available.value_or(false)) write_executable(name, skill);
  }
  return {};
}

Status SkillEngine::recover_executions() {
  ENGRAM_ASSIGN_OR_RETURN(const auto last, watched_.latest(segment_text(kEventSegment)));
  for (const ltm::Snapshot& snapshot : last) {
    records_.note(snapshot.entity, snapshot.time);
    auto event = ::skill::Event::from_idf(snapshot.instances.front().data);
    if (!event.ok()) {
      log::warning("skills: '{}' cannot be read: {}", snapshot.entity.printable(),
                   event.status().message());
      continue;
    }
    std::vector<Time> running = event->running;
    while (!running.empty()) {
      const Time started = running.front();
      running.erase(running.begin());
      ENGRAM_ASSIGN_OR_RETURN(const auto start, watched_.at(snapshot.entity, started));
      auto begun = start ? ::skill::Event::from_idf(start->instances.front().data)
                         : Result<::skill::Event>(not_found("no start"));
      ::skill::Event lost = begun.ok() ? *std::move(begun) : *event;
      lost.stage = ::skill::Stage::ENDED;
      lost.outcome = ::skill::Outcome::LOST;
      lost.reason = "the skill memory was restarted while it ran";
      lost.started = started;
      lost.execution = snapshot.entity.at(started).instance(0);
      lost.running = running;
      write_end(name_in(snapshot.entity), lost);
      ++counters_.ended;
      ++counters_.lost;
    }
  }
  ENGRAM_ASSIGN_OR_RETURN(const auto refused, watched_.latest(segment_text(kRefusalSegment)));
  for (const ltm::Snapshot& snapshot : refused) records_.note(snapshot.entity, snapshot.time);
  return {};
}

Status SkillEngine::recover_requests() {
  const auto recent = [&](std::string_view segment) {
    return watched_.select(segment_text(segment), kLookBack);
  };
  ENGRAM_ASSIGN_OR_RETURN(const auto requests, recent(kRequestSegment));
  if (requests.empty()) return {};
  std::set<std::string> answered;
  ENGRAM_ASSIGN_OR_RETURN(const auto events, recent(kEventSegment));
  for (const ltm::Snapshot& snapshot : events)
    if (const auto event = ::skill::Event::from_idf(snapshot.instances.front().data); event.ok())
      answered.insert(event->request.to_string());
  ENGRAM_ASSIGN_OR_RETURN(const auto refusals, recent(kRefusalSegment));
  for (const ltm::Snapshot& snapshot : refusals)
    if (const auto refusal = ::skill::Refusal::from_idf(snapshot.instances.front().data);
        refusal.ok())
      answered.insert(refusal->request.to_string());
  for (const ltm::Snapshot& snapshot : requests) {
    records_.note(snapshot.entity, snapshot.time);
    const ltm::MemoryId id = snapshot.id().instance(0);
    const auto request = ::skill::ExecutionRequest::from_idf(snapshot.instances.front().data);
    if (answered.contains(id.to_string()) || !request.ok()) {
      mark_answered(id);
      continue;
    }
    // Nobody expects a robot to move for what was asked before it was switched off. What only
    // this process missed is carried out.
    const bool is_recent = carries_out_since_ && snapshot.time >= *carries_out_since_;
    if (is_recovered_ || is_recent) {
      on_request(snapshot);
    } else if (mark_answered(id) && request->wish == ::skill::Wish::RUN) {
      refuse(name_in(snapshot.entity), id, "the skill memory was restarted before it began");
    }
  }
  is_recovered_ = true;
  return {};
}

Status SkillEngine::take_skill(const SkillName& name, SkillDescription description, bool is_prior) {
  KnownSkill skill{.description = std::move(description), .is_prior = is_prior};
  if (!skill.description.when.is_empty()) {
    ENGRAM_ASSIGN_OR_RETURN(skill.when, ConditionState::create(skill.description.when));
    skill.watched = skill.when->patterns();
    ENGRAM_RETURN_IF_ERROR(watched_.watch(skill.watched));
    ENGRAM_RETURN_IF_ERROR(seed(*skill.when));
  }
  if (const auto known = skills_.find(name); known != skills_.end()) {
    watched_.unwatch(known->second.watched);
    skill.executable = known->second.executable;
    skill.is_enabled = known->second.is_enabled;
    skill.running = known->second.running;
  }
  skills_.insert_or_assign(name, std::move(skill));
  return {};
}

Status SkillEngine::introduce(const ProviderHello& hello) {
  std::vector<SkillDescription> all;
  std::set<std::string> names;
  for (const std::string& text : hello.skills) {
    // A name alone means what is known before. A description has a colon.
    const bool is_name = text.find(':') == std::string::npos;
    const auto known = is_name ? skills_.find({hello.provider, text}) : skills_.end();
    if (is_name && known == skills_.end())
      return not_found("provider '{}': skill '{}' is not known before, needs a description",
                       hello.provider, text);
    ENGRAM_ASSIGN_OR_RETURN(
        SkillDescription description,
        SkillDescription::parse(is_name ? known->second.description.text : text));
    if (!names.insert(description.name).second)
      return invalid_argument("provider '{}': found skill '{}' twice", hello.provider,
                              description.name);
    const auto before = skills_.find({hello.provider, description.name});
    if (before != skills_.end() && before->second.is_prior &&
        before->second.description.version != description.version)
      return failed_precondition(
          "provider '{}': skill '{}' has version {}, but version {} is known before",
          hello.provider, description.name, description.version,
          before->second.description.version);
    all.push_back(std::move(description));
  }
  for (SkillDescription& description : all) {
    const SkillName name{hello.provider, description.name};
    const auto before = skills_.find(name);
    const bool is_prior = before != skills_.end() && before->second.is_prior;
    ENGRAM_RETURN_IF_ERROR(take_skill(name, std::move(description), is_prior));
    KnownSkill& skill = skills_.at(name);
    skill.is_available = true;
    write_executable(name, skill);
  }
  if (!names.empty())
    log::info("skills: provider '{}' has {}", hello.provider, fmt::join(names, ", "));
  return {};
}

Status SkillEngine::remove(const std::string& provider, const std::vector<std::string>& skills) {
  for (const std::string& skill : skills) {
    const auto found = skills_.find({provider, skill});
    if (found == skills_.end() || !found->second.is_available)
      return not_found("provider '{}': has no skill '{}'", provider, skill);
    found->second.is_available = false;
    write_executable(found->first, found->second);
  }
  look_at_attempts();
  return {};
}

void SkillEngine::write_executable(const SkillName& name, KnownSkill& skill) {
  ::skill::Executable value;
  value.description = skill.description.text;
  value.doc = skill.description.doc;
  value.version = skill.description.version;
  value.is_available = skill.is_available;
  value.is_enabled = skill.is_enabled;
  std::vector<::skill::Parameter>& parameters = value.parameters.emplace();
  for (const SkillParameter& parameter : skill.description.parameters.all()) {
    ::skill::Parameter& one = parameters.emplace_back();
    one.name = parameter.name;
    one.type = parameter.type_name;
    if (const idf::Quantity* quantity = parameter.type.quantity()) one.unit = quantity->unit;
    one.doc = parameter.doc;
    if (!parameter.default_value) continue;
    auto text = idf::to_json_text(*parameter.default_value);
    if (text.ok()) one.default_json = *std::move(text);
  }
  auto written = records_.add(name, value);
  if (written.ok())
    skill.executable = *std::move(written);
  else
    log::warning("skills: '{}' could not be noted: {}", name.to_string(),
                 written.status().message());
}

void SkillEngine::take_away(const std::string& provider) {
  for (auto& [name, skill] : skills_) {
    if (name.provider != provider || !skill.is_available) continue;
    skill.is_available = false;
    write_executable(name, skill);
  }
}

void SkillEngine::set_enabled(const SkillName& name, bool is_enabled) {
  KnownSkill& skill = skills_.at(name);
  if (skill.is_enabled == is_enabled) return;
  skill.is_enabled = is_enabled;
  write_executable(name, skill);
  if (is_enabled && skill.when) on_condition(name, skill);
}

Result<SkillName> SkillEngine::find(const std::string& text) const {
  std::vector<SkillName> found;
  std::vector<std::string> words;
  for (const auto& [name, skill] : skills_) {
    if (name.to_string() == text) return name;
    if (name.skill == text) found.push_back(name);
    words.push_back(name.to_string());
    words.push_back(name.skill);
  }
  if (found.size() == 1) return found.front();
  if (found.size() > 1) {
    std::vector<std::string> names;
    for (const SkillName& name : found) names.push_back(name.to_string());
    return invalid_argument("skill '{}': found several, needs one of {}", text,
                            fmt::join(names, ", "));
  }
  const auto close = closest_word(text, words);
  return not_found("skill '{}': there is no such skill{}", text,
                   close ? fmt::format(", did you mean '{}'?", *close) : "");
}

}  // namespace engram::skills
