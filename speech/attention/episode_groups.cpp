// SPDX-License-Identifier: Apache-2.0
#include "speech/attention/episode_groups.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "ltm/core/ascii.h"
#include "ltm/core/check.h"
#include "speech/facts/facts_as_of.h"
#include "speech/program/filter_texts.h"

namespace engram::speech {

namespace {

constexpr const char* kStopText = "stop";
constexpr size_t kOutcomeCount = 5;  // Of ltm::ActionOutcome.

auto key_of(const EpisodeGroup& group) {
  return std::tie(group.source, group.skill, group.outcome, group.has_thing, group.has_place,
                  group.has_hand, group.has_person, group.has_text, group.is_held,
                  group.is_visible);
}

struct IsBefore {
  bool operator()(const EpisodeGroup& a, const EpisodeGroup& b) const {
    return key_of(a) < key_of(b);
  }
};

bool is_among(const std::vector<ltm::MemoryId>& all, const std::optional<ltm::MemoryId>& one) {
  return one && std::find(all.begin(), all.end(), *one) != all.end();
}

bool contains(const std::string& text, const std::string& part) {
  return lower_ascii(text).find(lower_ascii(part)) != std::string::npos;
}

/// Sorts records into groups.
class Grouper {
 public:
  Grouper(FactsAsOf& facts, const AskedNames& names) : facts_(facts), names_(names) {
    for (const std::string& thing : names.things)
      things_.push_back(facts.world().things_called(thing));
    for (const std::string& place : names.places)
      places_.push_back(facts.world().places_called(place));
  }

  void add_executions() {
    for (const Execution* one : facts_.executions()) {
      const Execution& execution = *one;
      EpisodeGroup group = group_of(ProgramSource::kExecutions);
      group.skill = execution.skill;
      group.outcome = execution.outcome;
      name(group, execution.thing, execution.place, execution.hand);
      tell(group, execution.reason);
      // Whose words caused it is told by links, which are followed only where it is asked for.
      if (!names_.persons.empty()) speak(group, speaker_of(execution));
      add(std::move(group), execution.started);
    }
  }

  void add_rest() {
    for (const SpokenWords& words : facts_.words()) {
      EpisodeGroup group = group_of(ProgramSource::kWords);
      tell(group, words.text);
      speak(group, words.speaker);
      add(std::move(group), words.time);
    }
    for (const TaskPlan& plan : facts_.plans()) {
      EpisodeGroup group = group_of(ProgramSource::kPlans);
      tell(group, plan.goal);
      for (const PlannedStep& step : plan.steps) name(group, step.thing, step.place, {});
      const SpokenWords* words = plan.command ? facts_.words_at(*plan.command) : nullptr;
      if (words != nullptr) speak(group, words->speaker);
      add(std::move(group), plan.time);
    }
    for (const RefusedRequest& refusal : facts_.refusals()) {
      EpisodeGroup group = group_of(ProgramSource::kRefusals);
      group.skill = refusal.skill;
      tell(group, refusal.reason);
      add(std::move(group), refusal.time);
    }
    for (const DriveNote& note : facts_.drives()) {
      EpisodeGroup group = group_of(ProgramSource::kDrives);
      tell(group, note.goal + " " + note.reason);
      add(std::move(group), note.time);
    }
    add(group_of(ProgramSource::kRobot), facts_.now());
  }

  Status add_things(Time at) {
    ENGRAM_ASSIGN_OR_RETURN(const std::vector<ThingState> states, facts_.things_at(at));
    for (const ThingState& state : states) {
      EpisodeGroup group = group_of(ProgramSource::kThings);
      const KnownPlace* place =
          state.spot && state.held_by.empty() ? facts_.world().under(*state.spot) : nullptr;
      name(group, state.id.entity(), place != nullptr ? std::optional(place->entity) : std::nullopt,
           state.held_by);
      group.is_held = !state.held_by.empty();
      group.is_visible = state.is_visible.value_or(false);
      add(std::move(group), state.time);
    }
    return {};
  }

  [[nodiscard]] std::vector<EpisodeGroup> take() {
    std::vector<EpisodeGroup> groups;
    for (const auto& [group, totals] : groups_) {
      groups.push_back(group);
      std::tie(groups.back().count, groups.back().first, groups.back().last) = totals;
    }
    return groups;
  }

 private:
  using Totals = std::tuple<size_t, Time, Time>;

  [[nodiscard]] EpisodeGroup group_of(ProgramSource source) const {
    EpisodeGroup group;
    group.source = source;
    group.has_thing.resize(names_.things.size());
    group.has_place.resize(names_.places.size());
    group.has_hand.resize(names_.hands.size());
    group.has_person.resize(names_.persons.size());
    group.has_text.resize(names_.things.size() + names_.places.size() + 1);
    return group;
  }

  void name(EpisodeGroup& group, const std::optional<ltm::MemoryId>& thing,
            const std::optional<ltm::MemoryId>& place, const std::string& hand) const {
    for (size_t i = 0; i < things_.size(); ++i)
      if (is_among(things_[i], thing)) group.has_thing[i] = true;
    for (size_t i = 0; i < places_.size(); ++i)
      if (is_among(places_[i], place)) group.has_place[i] = true;
    for (size_t i = 0; i < names_.hands.size(); ++i)
      if (lower_ascii(hand) == lower_ascii(names_.hands[i])) group.has_hand[i] = true;
  }

  void tell(EpisodeGroup& group, const std::string& text) const {
    size_t at = 0;
    for (const std::string& thing : names_.things) group.has_text[at++] = contains(text, thing);
    for (const std::string& place : names_.places) group.has_text[at++] = contains(text, place);
    group.has_text[at] = contains(text, kStopText);
  }

  void speak(EpisodeGroup& group, const std::string& speaker) const {
    for (size_t i = 0; i < names_.persons.size(); ++i)
      if (lower_ascii(speaker) == lower_ascii(names_.persons[i])) group.has_person[i] = true;
  }

  [[nodiscard]] std::string speaker_of(const Execution& execution) const {
    const TaskPlan* plan = execution.plan ? facts_.plan_at(*execution.plan) : nullptr;
    const SpokenWords* words =
        plan != nullptr && plan->command ? facts_.words_at(*plan->command) : nullptr;
    return words != nullptr ? words->speaker : std::string();
  }

  void add(EpisodeGroup group, Time time) {
    const auto [at, is_new] = groups_.try_emplace(std::move(group), 0, time, time);
    auto& [count, first, last] = at->second;
    ++count;
    first = std::min(first, time);
    last = std::max(last, time);
  }

  FactsAsOf& facts_;
  const AskedNames& names_;
  std::vector<std::vector<ltm::MemoryId>> things_;
  std::vector<std::vector<ltm::MemoryId>> places_;
  std::map<EpisodeGroup, Totals, IsBefore> groups_;
};

/// The moment at which things are asked about.
Time moment_of(const AskedTimes& times, Time now, DayZone zone) {
  for (const auto* time : {&times.at, &times.during, &times.before, &times.after}) {
    if (!*time) continue;
    const auto period = resolve_period(**time, now, zone);
    if (period.ok()) return std::min(period->to, now);
  }
  return now;
}

bool is_any_named(const std::string& wanted, const std::vector<std::string>& names,
                  const std::vector<bool>& has) {
  const std::vector<std::string> parts = names_in_list(wanted);
  for (size_t i = 0; i < names.size(); ++i)
    if (has[i] && std::find(parts.begin(), parts.end(), names[i]) != parts.end()) return true;
  return false;
}

bool keeps_text(const std::string& wanted, const EpisodeGroup& group, const AskedNames& names) {
  size_t at = 0;
  for (const auto* all : {&names.things, &names.places})
    for (const std::string& name : *all) {
      if (name == wanted) return group.has_text[at];
      ++at;
    }
  return wanted == kStopText && group.has_text[at];
}

bool keeps(const ProgramFilter& filter, const EpisodeGroup& group, const AskedNames& names) {
  const std::string& text = filter.value.text;
  const auto is_flag = [&](bool flag) { return flag == (text == "yes"); };
  switch (filter.key) {
    case FilterKey::kSkill: {
      const auto skills = names_in_list(text);
      return std::find(skills.begin(), skills.end(), group.skill) != skills.end();
    }
    case FilterKey::kThing:
      return is_any_named(text, names.things, group.has_thing);
    case FilterKey::kPlace:
      // Where the robot is, the program finds out.
      return group.source == ProgramSource::kRobot ||
             is_any_named(text, names.places, group.has_place);
    case FilterKey::kHand:
      return is_any_named(text, names.hands, group.has_hand);
    case FilterKey::kSpeaker:
      return is_any_named(text, names.persons, group.has_person);
    case FilterKey::kOutcome:
      return group.outcome && fits_outcome(text, *group.outcome);
    case FilterKey::kText:
      return keeps_text(text, group, names);
    case FilterKey::kIsHeld:
      return is_flag(group.is_held);
    case FilterKey::kVisible:
      return is_flag(group.is_visible);
    default:
      return true;
  }
}

/// Numbers one after the other.
class TraitWriter {
 public:
  void add(double value) {
    if (at_ < traits_.size()) traits_[at_] = static_cast<float>(value);
    ++at_;
  }
  void add_one_of(size_t index, size_t count) {
    for (size_t i = 0; i < count; ++i) add(i == index ? 1 : 0);
  }
  /// The first two of the flags, and whether any of them is set.
  void add_flags(const std::vector<bool>& flags) {
    for (size_t i = 0; i < 2; ++i) add(i < flags.size() && flags[i] ? 1 : 0);
    add(std::find(flags.begin(), flags.end(), true) != flags.end() ? 1 : 0);
  }
  /// All numbers have to be there: a network takes each by its place.
  [[nodiscard]] const AttentionInput::Traits& traits() const {
    ENGRAM_CHECK(at_ == traits_.size(), "a group has {} traits, needs {}", at_, traits_.size());
    return traits_;
  }

 private:
  AttentionInput::Traits traits_{};
  size_t at_ = 0;
};

bool is_of_skills(const std::string& skill, const std::string& skills) {
  const auto parts = names_in_list(skills);
  return !skill.empty() && std::find(parts.begin(), parts.end(), skill) != parts.end();
}

}  // namespace

Result<std::vector<EpisodeGroup>> episode_groups(KnownFacts& facts, const AskedNames& names,
                                                 const AskedTimes& times, Time now, DayZone zone) {
  FactsAsOf known(facts, now);
  Grouper grouper(known, names);
  grouper.add_executions();
  grouper.add_rest();
  ENGRAM_RETURN_IF_ERROR(grouper.add_things(moment_of(times, now, zone)));
  return grouper.take();
}

bool keeps(const Program& program, const EpisodeGroup& group, const AskedNames& names) {
  return program.source == group.source &&
         std::all_of(program.filters.begin(), program.filters.end(),
                     [&](const ProgramFilter& filter) {
                       return filter.value.program != nullptr || keeps(filter, group, names);
                     });
}

AttentionInput::Traits traits_of(const EpisodeGroup& group, const AskedNames& names, Time now) {
  TraitWriter writer;
  writer.add_one_of(static_cast<size_t>(group.source), 7);
  writer.add_one_of(group.outcome ? static_cast<size_t>(*group.outcome) : kOutcomeCount,
                    kOutcomeCount);
  writer.add_flags(group.has_thing);
  writer.add_flags(group.has_place);
  writer.add_flags(group.has_hand);
  writer.add_flags(group.has_person);
  writer.add_flags(group.has_text);
  writer.add(group.has_text.back() ? 1 : 0);
  std::vector<bool> is_asked;
  for (const std::string& skills : names.skills)
    is_asked.push_back(is_of_skills(group.skill, skills));
  writer.add_flags(is_asked);
  writer.add(group.is_held ? 1 : 0);
  writer.add(group.is_visible ? 1 : 0);
  writer.add(std::log1p(static_cast<double>(group.count)) / 4);
  writer.add(std::log1p(std::max(0.0, to_seconds(now - group.first))) / 10);
  writer.add(std::log1p(std::max(0.0, to_seconds(now - group.last))) / 10);
  return writer.traits();
}

std::vector<uint32_t> attended_first(const std::vector<EpisodeGroup>& groups,
                                     const AskedNames& names) {
  const auto relevance = [&](const EpisodeGroup& group) {
    double sum = 0;
    for (const auto* flags :
         {&group.has_thing, &group.has_place, &group.has_hand, &group.has_person, &group.has_text})
      sum += static_cast<double>(std::count(flags->begin(), flags->end(), true));
    for (const std::string& skills : names.skills) sum += is_of_skills(group.skill, skills) ? 1 : 0;
    return sum;
  };
  std::vector<uint32_t> order(groups.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    const double of_a = relevance(groups[a]);
    const double of_b = relevance(groups[b]);
    return of_a != of_b ? of_a > of_b : groups[a].last > groups[b].last;
  });
  order.resize(std::min(order.size(), AttentionInput::kMaxAttended));
  return order;
}

}  // namespace engram::speech
