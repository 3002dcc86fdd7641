// SPDX-License-Identifier: Apache-2.0
#include "ltm/reflection/action_log.h"

#include <algorithm>
#include <ranges>
#include <tuple>

#include "ltm/idf/json.h"
#include "ltm/reflection/robust.h"

namespace engram::ltm {

namespace {

/// Steps of a chain that are told.
constexpr size_t kMaxChainSteps = 6;
constexpr size_t kMaxChains = 20;
/// Share of actions that overlap others of their provider segment, up to which they come one after
/// the other.
constexpr double kOverlapShare = 0.1;

std::string text_member(const idf::Dict& dict, std::string_view name) {
  const idf::Data* found = dict.find(name);
  const auto* text = found == nullptr ? nullptr : found->get_if<std::string>();
  return text == nullptr ? std::string() : *text;
}

/// The name of the entity that a link leads to; a text that is no link stays as it is.
std::string name_behind(const std::string& text) {
  const auto id = MemoryId::parse(text);
  return id.ok() && id->has_entity() ? id->names().back() : text;
}

std::optional<Time> time_member(const idf::Dict& dict, std::string_view name) {
  const idf::Data* found = dict.find(name);
  const auto* ns = found == nullptr ? nullptr : found->get_if<int64_t>();
  return ns == nullptr ? std::nullopt : std::optional(time_from_ns(*ns));
}

}  // namespace

bool ActionLog::add(const MemoryId& entity, Time time, const idf::Data& value,
                    const std::optional<idf::Type>& type) {
  const auto* dict = value.get_if<idf::Dict>();
  if (dict == nullptr) return false;
  const idf::Data* outcome = dict->find("outcome");
  Row row{entity, time, text_member(*dict, "skill")};
  if (row.skill.empty() || outcome == nullptr) return false;
  if (rows_.size() >= kMaxActions) return true;
  row.outcome = outcome_of(*outcome, "outcome", type);
  const auto started = time_member(*dict, "started");
  row.has_started = started.has_value();
  row.started = started.value_or(time);
  take_names(*dict, row);
  // An event of a skill has them in its parameters, which are JSON.
  if (const std::string text = text_member(*dict, "parameters"); !text.empty())
    if (const auto parameters = idf::from_json_text(text); parameters.ok())
      if (const auto* named = parameters->get_if<idf::Dict>()) take_names(*named, row);
  rows_.push_back(std::move(row));
  return true;
}

void ActionLog::take_names(const idf::Dict& dict, Row& row) {
  if (row.hand.empty()) row.hand = text_member(dict, "hand");
  for (const idf::DictEntry& member : dict)
    if (row.object.empty() && member.key.starts_with("object"))
      row.object = name_behind(text_member(dict, member.key));
  for (const char* name : {"surface", "place", "location", "target"})
    if (row.place.empty()) row.place = name_behind(text_member(dict, name));
}

/// Snapshots of one entity that began at the same time are of one action.
std::vector<ActionLog::Action> ActionLog::actions() const {
  std::map<std::pair<MemoryId, Time>, Action> found;
  for (const Row& row : rows_) {
    Action& action = found[{row.entity, row.started}];
    action.row = &row;
    action.started = row.started;
    if (row.outcome == ActionOutcome::kRunning) {
      action.has_begun = true;
    } else {
      action.outcome = row.outcome;
      action.ended = action.ended ? std::min(*action.ended, row.time) : row.time;
    }
  }
  std::vector<Action> actions;
  for (const Action& action : found | std::views::values) actions.push_back(action);
  std::ranges::stable_sort(actions, {}, &Action::started);
  return actions;
}

void ActionLog::find_broken(const std::vector<Action>& actions, Time end, Reflection& reflection,
                            const std::map<MemoryId, EntityReflection*>& entities,
                            FindingList& findings) {
  std::map<MemoryId, std::vector<const Action*>> by_segment;
  for (const Action& action : actions) by_segment[action.row->entity.parent()].push_back(&action);
  for (const auto& [segment, all] : by_segment) {
    const auto begun = std::ranges::count_if(all, [](const Action* a) { return a->has_begun; });
    const auto ended =
        std::ranges::count_if(all, [](const Action* a) { return a->ended.has_value(); });
    // Where only results are recorded, nothing begins.
    const bool has_begins = 2 * begun > static_cast<ptrdiff_t>(all.size());
    const bool has_ends = 2 * ended > static_cast<ptrdiff_t>(all.size());
    size_t overlaps = 0;
    Duration longest{};
    for (size_t i = 0; i < all.size(); ++i) {
      if (!all[i]->ended) continue;
      longest = std::max(longest, *all[i]->ended - all[i]->started);
      if (i + 1 < all.size() && all[i + 1]->started < *all[i]->ended) ++overlaps;
    }
    const bool is_one_by_one =
        static_cast<double>(overlaps) <= kOverlapShare * static_cast<double>(all.size());
    for (size_t i = 0; i < all.size(); ++i) {
      const Action& action = *all[i];
      if (const auto known = entities.find(action.row->entity); known != entities.end())
        known->second->looked_at.insert(ReflectionKind::kBrokenAction);
      const bool is_followed = is_one_by_one && i + 1 < all.size();
      const Time until = is_followed ? all[i + 1]->started : end;
      if (has_begins && !action.ended && has_ends &&
          (is_followed || end - action.started > 3 * longest)) {
        findings.add({ReflectionKind::kBrokenAction, Severity::kFault, action.row->entity, "",
                      action.started, until, 1,
                      fmt::format("{} began and did not end", action.row->skill),
                      is_followed ? "its end before the next action begins" : "its end"});
      } else if (has_begins && action.ended && !action.has_begun) {
        findings.add({ReflectionKind::kBrokenAction, Severity::kFault, action.row->entity, "",
                      action.started, *action.ended, 1,
                      fmt::format("{} ended and did not begin", action.row->skill),
                      "a snapshot of its begin"});
      }
    }
  }
  for (SkillReflection& skill : reflection.skills)
    skill.unfinished =
        static_cast<uint64_t>(std::ranges::count_if(actions, [&](const Action& action) {
          return !action.ended && action.row->skill == skill.skill;
        }));
}

void ActionLog::rate_skills(const std::vector<Action>& actions, Reflection& reflection) {
  using Key = std::tuple<std::string, int, std::string>;
  constexpr std::array<const char*, 4> kBy{"all", "object", "hand", "place"};
  std::map<Key, SuccessRate> rates;
  for (const Action& action : actions) {
    const Row& row = *action.row;
    const std::array<std::string, 4> names{"", row.object, row.hand, row.place};
    for (int by = 0; by < 4; ++by) {
      const std::string& name = names[static_cast<size_t>(by)];
      SuccessRate& rate = rates[{row.skill, by, by > 0 && name.empty() ? "-" : name}];
      rate.by = kBy[static_cast<size_t>(by)];
      if (!action.ended) continue;
      ++rate.runs;
      rate.successes += action.outcome == ActionOutcome::kSuccess ? 1 : 0;
      rate.failures += action.outcome == ActionOutcome::kFailure ? 1 : 0;
      rate.stops += action.outcome == ActionOutcome::kStop ? 1 : 0;
      rate.mean_duration_s += to_seconds(*action.ended - action.started);
    }
  }
  for (auto& [key, rate] : rates) {
    const auto& [skill, by, name] = key;
    rate.name = name;
    if (rate.runs > 0) rate.mean_duration_s /= static_cast<double>(rate.runs);
    std::tie(rate.low, rate.high) = wilson_interval(rate.successes, rate.runs);
    if (reflection.skills.empty() || reflection.skills.back().skill != skill)
      reflection.skills.push_back({skill, 0, {}});
    reflection.skills.back().rates.push_back(std::move(rate));
  }
}

/// A chain begins with an action that did not succeed, and ends with the success of the same skill.
void ActionLog::find_chains(const std::vector<Action>& actions, Reflection& reflection) {
  std::map<MemoryId, std::vector<const Action*>> by_segment;
  for (const Action& action : actions)
    if (action.ended) by_segment[action.row->entity.parent()].push_back(&action);
  std::map<std::vector<std::string>, uint64_t> chains;
  for (const auto& all : by_segment | std::views::values) {
    for (size_t i = 0; i < all.size(); ++i) {
      if (all[i]->outcome != ActionOutcome::kFailure && all[i]->outcome != ActionOutcome::kStop)
        continue;
      const std::string& skill = all[i]->row->skill;
      std::vector<std::string> steps;
      size_t at = i;
      for (; at < all.size() && steps.size() < kMaxChainSteps; ++at) {
        steps.push_back(fmt::format("{} {}", all[at]->row->skill, name_of(all[at]->outcome)));
        if (all[at]->outcome == ActionOutcome::kSuccess && all[at]->row->skill == skill) break;
      }
      ++chains[steps];
      i = std::min(at, all.size() - 1);
    }
  }
  for (const auto& [steps, count] : chains) reflection.chains.push_back({steps, count});
  std::ranges::stable_sort(reflection.chains, std::greater(), &FailureChain::count);
  if (reflection.chains.size() > kMaxChains) reflection.chains.resize(kMaxChains);
}

void ActionLog::reflect(Time end, Reflection& reflection,
                        const std::map<MemoryId, EntityReflection*>& entities,
                        FindingList& findings) const {
  const std::vector<Action> all = actions();
  rate_skills(all, reflection);
  find_broken(all, end, reflection, entities, findings);
  find_chains(all, reflection);
}

}  // namespace engram::ltm
