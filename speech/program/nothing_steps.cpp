// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "ltm/filter/saturated_time.h"
#include "speech/program/program_run.h"

namespace engram::speech {

namespace {

constexpr std::string_view kRole = "looked at";
/// Of so many executions that did not fit, and of so many things, nobody reads more.
constexpr size_t kMaxRelated = 6;
constexpr size_t kMaxThings = 50;
/// A filter of a memory may leave out what did not change for some seconds, so a moment has a
/// record if there is one so shortly before it.
constexpr Duration kMaxSilence = std::chrono::minutes(1);

constexpr Duration kMaxSilentExecution = std::chrono::hours(1);

/// With what lies right before it, where it is a moment or little more.
Period widened(Period period) {
  if (ltm::saturated_add(period.to, -kMaxSilence) <= period.from)
    period.from = ltm::saturated_add(period.from, -kMaxSilence);
  return period;
}

/// Whether the events of an execution tell of a time. What was lost may have ended at any time
/// before that was found out.
bool tells_of(const Execution& execution, Period period) {
  if (period.contains(execution.started)) return true;
  if (!execution.ended) return false;
  return period.contains(*execution.ended) ||
         (execution.has_known_end() && execution.started <= period.to &&
          *execution.ended >= period.from);
}

bool is_named(const ProgramStep& step, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), step.argument->text) != names.end();
}

}  // namespace

/// Leaves out what may have ended long before: no end is known, and the memory is silent.
Status ProgramRun::drop_forgotten(Period at) {
  const auto is_unsure = [&](const Execution& one) {
    return !one.has_known_end() && one.started < ltm::saturated_add(at.from, -kMaxSilentExecution);
  };
  std::vector<Execution>& executions = outcome_.executions;
  if (std::none_of(executions.begin(), executions.end(), is_unsure)) return {};
  ENGRAM_ASSIGN_OR_RETURN(const auto records, records_of(at));
  if (records.empty()) std::erase_if(executions, is_unsure);
  return {};
}

/// What is nothing, and known to be. Which hand did it, when and why are asked of what was done,
/// and where nothing was, there is no answer.
Status ProgramRun::tell_nothing(const ProgramStep& step, const RecordFilter& filter) {
  if (step.kind == StepKind::kEvents) {
    outcome_.value = answers::Events{};
  } else if (step.kind == StepKind::kWhich && is_named(step, {"thing", "place", "skill"})) {
    outcome_.value = answers::Names{};
  } else if (step.kind == StepKind::kHowMany) {
    outcome_.value = answers::Count{0};
  } else {
    miss("the memory has none");
    return {};
  }
  return show_nothing(filter);
}

/// Cites what was looked at where nothing fits, first of all what was asked about. Where there is
/// no record of the time, it is not known that there was nothing.
Status ProgramRun::show_nothing(const RecordFilter& filter) {
  if (program_.source == ProgramSource::kThings) return show_no_thing(filter);
  Period period = filter.at() ? *filter.at() : filter.begun();
  if (filter.asks_running() && !filter.at()) period = {now_, now_};
  period.to = std::min(period.to, now_);
  ENGRAM_ASSIGN_OR_RETURN(const std::vector<ltm::MemoryId> records, records_of(period));
  if (records.empty()) {
    miss("the memory has no record of that time");
    return {};
  }
  if (program_.source == ProgramSource::kExecutions) {
    if (filter.at())
      cite_around(period);
    else
      cite_related(filter, period);
    ENGRAM_RETURN_IF_ERROR(cite_things_asked_about(filter, period.to));
  }
  const auto cite_last = [&](const auto& all) {
    std::vector<ltm::MemoryId> ids;
    for (const auto& one : all)
      if (period.contains(one.time)) ids.push_back(one.id);
    for (size_t i = ids.size() - std::min(ids.size(), kMaxRelated); i < ids.size(); ++i)
      outcome_.cite(ids[i], kRole);
  };
  if (program_.source == ProgramSource::kWords) cite_last(facts_.words());
  if (program_.source == ProgramSource::kPlans) cite_last(facts_.plans());
  if (program_.source == ProgramSource::kRefusals) cite_last(facts_.refusals());
  if (program_.source == ProgramSource::kDrives) cite_last(facts_.drives());
  if (outcome_.evidence.empty())
    for (const ltm::MemoryId& id : records) outcome_.cite(id, kRole);
  return {};
}

/// Where things are is told by their states.
Status ProgramRun::show_no_thing(const RecordFilter& filter) {
  // How a thing was holds until it is seen otherwise; that it was in sight does not.
  if (filter.is_visible() || has_span()) {
    Period period = filter.at() ? *filter.at() : filter.begun();
    if (!filter.at() && !has_span()) period = {now_, now_};
    ENGRAM_ASSIGN_OR_RETURN(const auto records, records_of(period));
    if (records.empty()) looked_at_.clear();
  }
  const auto has_top = [this](const ltm::MemoryId& entity) {
    const KnownPlace* place = facts_.world().place(entity);
    return place != nullptr && place->spot && place->depth_m > 0;
  };
  if (!std::all_of(filter.places().begin(), filter.places().end(), has_top))
    miss("it is not told how far that place reaches");
  if (is_place_untold_) miss("it is not told where it was");
  for (const ThingState& state : looked_at_)
    if (outcome_.evidence.size() < kMaxThings) outcome_.cite(state.id, kRole);
  if (looked_at_.empty()) miss("the memory has no record of that time");
  // Of the thing that is asked about it is told where it was instead.
  if (filter.has_things()) outcome_.states = looked_at_;
  return {};
}

/// How the things that are asked about were then.
Status ProgramRun::cite_things_asked_about(const RecordFilter& filter, Time at) {
  for (size_t i = 0; i < std::min(filter.things().size(), kMaxRelated); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const auto state, facts_.thing_at(filter.things()[i], at));
    if (state) outcome_.cite(state->id, kRole);
  }
  return {};
}

/// The last executions of the time that have most to do with what is asked about.
void ProgramRun::cite_related(const RecordFilter& filter, Period period) {
  std::vector<const Execution*> related;
  int max_relation = 1;
  for (const Execution* execution : facts_.executions()) {
    const int relation = period.contains(execution->started) ? filter.relation(*execution) : 0;
    if (relation < max_relation) continue;
    if (relation > max_relation) related.clear();
    max_relation = relation;
    related.push_back(execution);
  }
  const size_t first = related.size() - std::min(related.size(), kMaxRelated);
  for (size_t i = first; i < related.size(); ++i) {
    outcome_.cite(related[i]->start_id, kRole);
    if (related[i]->end_id) outcome_.cite(*related[i]->end_id, kRole);
  }
}

/// What went on at a time, or what was done right before and after it.
void ProgramRun::cite_around(Period period) {
  const Execution* before = nullptr;
  const Execution* after = nullptr;
  for (const Execution* execution : facts_.executions()) {
    if (execution->started > period.to) {
      after = execution;
      break;
    }
    if (execution->is_within(period.from, period.to))
      outcome_.cite(execution->start_id, kRole);
    else if (before == nullptr || before->latest_end() <= execution->latest_end())
      before = execution;
  }
  if (!outcome_.evidence.empty()) return;
  if (before != nullptr) outcome_.cite(before->end_id.value_or(before->start_id), kRole);
  if (after != nullptr) outcome_.cite(after->start_id, kRole);
}

/// Records of a time, at least one where the memory has any of it: the first and last executions,
/// and the last one of each other kind.
Result<std::vector<ltm::MemoryId>> ProgramRun::records_of(Period period) {
  std::vector<ltm::MemoryId> records;
  // After what came later and before what came earlier there is no time.
  if (period.from > period.to) return records;
  const Period wide = widened(period);
  for (const Execution* execution : facts_.executions()) {
    if (execution->started > wide.to) break;
    if (!tells_of(*execution, wide)) continue;
    records.resize(std::min<size_t>(records.size(), 1));
    records.push_back(execution->start_id);
  }
  const auto add_last = [&](const auto& all) {
    const auto after = std::upper_bound(all.begin(), all.end(), wide.to,
                                        [](Time to, const auto& one) { return to < one.time; });
    if (after != all.begin() && std::prev(after)->time >= wide.from)
      records.push_back(std::prev(after)->id);
  };
  add_last(facts_.words());
  add_last(facts_.plans());
  add_last(facts_.refusals());
  add_last(facts_.drives());
  if (!records.empty()) return records;
  ENGRAM_ASSIGN_OR_RETURN(const auto robot, facts_.robot_at(wide.to));
  if (robot && robot->time >= wide.from) records.push_back(robot->id);
  ENGRAM_ASSIGN_OR_RETURN(const auto states, facts_.things_at(wide.to));
  for (const ThingState& state : states)
    if (state.time >= wide.from && records.size() < kMaxRelated) records.push_back(state.id);
  return records;
}

}  // namespace engram::speech
