// SPDX-License-Identifier: Apache-2.0
#include "speech/program/program_run.h"

#include <algorithm>

#include "speech/program/looked_for.h"

namespace engram::speech {

namespace {

/// Keeps one record of several; false where there is no such one.
template <typename Record>
bool keep_one(std::vector<Record>& records, size_t index) {
  if (index >= records.size()) return false;
  Record kept = std::move(records[index]);
  records.assign(1, std::move(kept));
  return true;
}

std::optional<double> number_of(const AnswerValue& value) {
  if (const auto* count = std::get_if<answers::Count>(&value))
    return static_cast<double>(count->value);
  if (const auto* length = std::get_if<answers::Seconds>(&value)) return length->value;
  if (const auto* way = std::get_if<answers::Metres>(&value)) return way->value;
  return {};
}

}  // namespace

void ProgramRun::miss(std::string why) {
  if (!is_missed()) outcome_.missing = std::move(why);
}

size_t ProgramRun::size() const {
  return outcome_.executions.size() + outcome_.words.size() + outcome_.plans.size() +
         outcome_.states.size() + refusals_.size() + drives_.size();
}

Result<std::optional<Time>> ProgramRun::inner_time(const Program& program) {
  ENGRAM_ASSIGN_OR_RETURN(const Outcome inner, ProgramRun(program, facts_, zone_).run());
  const auto* moment = std::get_if<answers::Moment>(&inner.value);
  if (moment == nullptr) {
    miss(inner.missing);
    return std::optional<Time>();
  }
  for (const Evidence& evidence : inner.evidence) outcome_.cite(evidence.id, evidence.role);
  return std::optional(moment->value);
}

Result<Outcome> ProgramRun::run() {
  outcome_.looked_for = looked_for(program_);
  ENGRAM_ASSIGN_OR_RETURN(RecordFilter filter, RecordFilter::create(program_, facts_, zone_,
                                                                    [this](const Program& inner) {
                                                                      return inner_time(inner);
                                                                    }));
  if (!filter.missing().empty()) miss(filter.missing());
  if (!is_missed()) ENGRAM_RETURN_IF_ERROR(collect(filter));
  for (const ProgramStep& step : program_.steps) {
    if (is_missed()) break;
    ENGRAM_RETURN_IF_ERROR(apply(step, filter));
  }
  // What supports nothing is not told.
  if (!is_missed() && outcome_.evidence.empty() && !is_unknown(outcome_.value))
    miss("the memory has nothing that shows it");
  if (is_missed()) {
    outcome_.value = answers::Unknown{};
    outcome_.evidence.clear();
  }
  return std::move(outcome_);
}

Status ProgramRun::collect(RecordFilter& filter) {
  const auto keep = [&filter](const auto& all, auto& kept) {
    for (const auto& record : all)
      if (filter.keeps(record)) kept.push_back(record);
  };
  switch (program_.source) {
    case ProgramSource::kExecutions:
      for (const Execution* execution : facts_.executions()) {
        ENGRAM_ASSIGN_OR_RETURN(const bool is_kept, filter.keeps(*execution));
        if (is_kept) outcome_.executions.push_back(*execution);
      }
      if (filter.at()) return drop_forgotten(*filter.at());
      // What runs goes on now.
      return filter.asks_running() ? drop_forgotten({now_, now_}) : Status();
    case ProgramSource::kWords:
      keep(facts_.words(), outcome_.words);
      return {};
    case ProgramSource::kPlans:
      keep(facts_.plans(), outcome_.plans);
      return {};
    case ProgramSource::kRefusals:
      keep(facts_.refusals(), refusals_);
      return {};
    case ProgramSource::kDrives:
      keep(facts_.drives(), drives_);
      return {};
    case ProgramSource::kThings:
      return collect_things(filter);
    case ProgramSource::kRobot:
      return collect_robot(filter);
  }
  return {};
}

Status ProgramRun::apply(const ProgramStep& step, const RecordFilter& filter) {
  switch (step.kind) {
    case StepKind::kCount:
    case StepKind::kExists:
    case StepKind::kNone:
      return count_or_exists(step.kind, filter);
    case StepKind::kMoreThan:
    case StepKind::kLessThan:
    case StepKind::kEquals:
      return compare(step);
    case StepKind::kFirstSeen:
    case StepKind::kLastSeen:
      return seek_seen(step.kind == StepKind::kLastSeen, filter);
    default:
      break;
  }
  if (program_.source != ProgramSource::kRobot && size() == 0) return tell_nothing(step, filter);
  if (select(step)) return {};
  switch (step.kind) {
    case StepKind::kWhen:
      tell_when();
      return {};
    case StepKind::kAgo:
      tell_when();
      if (const auto* moment = std::get_if<answers::Moment>(&outcome_.value))
        outcome_.value = answers::Seconds{to_seconds(now_ - moment->value)};
      return {};
    case StepKind::kHowMany:
      tell_how_many(step.argument->text);
      return {};
    case StepKind::kWho:
      return tell_who();
    case StepKind::kWhich:
      tell_which(step.argument->text);
      return {};
    case StepKind::kSaid:
      return tell_said();
    default:
      break;
  }
  if (program_.source == ProgramSource::kThings || program_.source == ProgramSource::kRobot)
    return apply_to_things(step, filter);
  return apply_to_executions(step);
}

/// The steps that choose one record of any kind. Returns whether it was one of them.
bool ProgramRun::select(const ProgramStep& step) {
  size_t index = 0;
  if (step.kind == StepKind::kLast)
    index = size() - 1;
  else if (step.kind == StepKind::kNth)
    index = static_cast<size_t>(std::stoi(step.argument->text)) - 1;
  else if (step.kind != StepKind::kFirst)
    return false;
  const bool is_kept = keep_one(outcome_.executions, index) || keep_one(outcome_.words, index) ||
                       keep_one(outcome_.plans, index) || keep_one(outcome_.states, index) ||
                       keep_one(refusals_, index) || keep_one(drives_, index);
  if (!is_kept) miss(fmt::format("the memory has only {}", size()));
  return true;
}

Status ProgramRun::count_or_exists(StepKind kind, const RecordFilter& filter) {
  if (program_.source == ProgramSource::kRobot) {
    tell_is_at(kind, filter);
    return {};
  }
  if (kind == StepKind::kCount)
    outcome_.value = answers::Count{static_cast<int64_t>(size())};
  else
    outcome_.value = answers::YesNo{(size() > 0) == (kind == StepKind::kExists)};
  for (const Execution& execution : outcome_.executions) outcome_.cite(execution);
  for (const SpokenWords& words : outcome_.words) outcome_.cite(words.id, "words");
  for (const TaskPlan& plan : outcome_.plans) outcome_.cite(plan.id, "plan");
  for (const ThingState& state : outcome_.states) outcome_.cite(state);
  for (const RefusedRequest& refusal : refusals_) outcome_.cite(refusal.id, "refusal");
  for (const DriveNote& note : drives_) outcome_.cite(note.id, "drive");
  return size() > 0 ? Status() : show_nothing(filter);
}

Status ProgramRun::compare(const ProgramStep& step) {
  ENGRAM_ASSIGN_OR_RETURN(const Outcome other,
                          ProgramRun(*step.argument->program, facts_, zone_).run());
  if (is_unknown(other.value)) {
    miss(other.missing);
    return {};
  }
  const auto* moment = std::get_if<answers::Moment>(&outcome_.value);
  const auto* other_moment = std::get_if<answers::Moment>(&other.value);
  const auto number = number_of(outcome_.value);
  const auto other_number = number_of(other.value);
  // Times are integers, and as numbers of seconds would lose their last digits.
  std::optional<std::partial_ordering> order;
  if (moment != nullptr && other_moment != nullptr) order = moment->value <=> other_moment->value;
  if (number && other_number) order = *number <=> *other_number;
  // Names are equal or not.
  if (std::holds_alternative<answers::Names>(outcome_.value) &&
      std::holds_alternative<answers::Names>(other.value))
    order = outcome_.value == other.value ? std::partial_ordering::equivalent
                                          : std::partial_ordering::unordered;
  if (!order) {
    miss("both are of other kinds");
    return {};
  }
  for (const Evidence& evidence : other.evidence) outcome_.cite(evidence.id, evidence.role);
  outcome_.executions.insert(outcome_.executions.end(), other.executions.begin(),
                             other.executions.end());
  if (step.kind == StepKind::kMoreThan) outcome_.value = answers::YesNo{*order > 0};
  if (step.kind == StepKind::kLessThan) outcome_.value = answers::YesNo{*order < 0};
  if (step.kind == StepKind::kEquals) outcome_.value = answers::YesNo{*order == 0};
  return {};
}

Result<Outcome> execute(const Program& program, KnownFacts& facts, Time now, DayZone zone) {
  ENGRAM_RETURN_IF_ERROR(program.validate());
  FactsAsOf as_of(facts, now);
  return ProgramRun(program, as_of, zone).run();
}

}  // namespace engram::speech
