// SPDX-License-Identifier: Apache-2.0
#include "speech/program/record_filter.h"

#include <algorithm>

#include "ltm/core/ascii.h"
#include "ltm/core/printable.h"
#include "speech/program/filter_texts.h"

namespace engram::speech {

namespace {

/// An entity by its ID, or all that have a name.
std::vector<ltm::MemoryId> entities_called(const KnownWorld& world, const std::string& name,
                                           bool is_thing) {
  const auto id = ltm::MemoryId::parse(name);
  if (!id.ok() || !id->has_entity())
    return is_thing ? world.things_called(name) : world.places_called(name);
  const bool is_known =
      is_thing ? world.thing(id->entity()) != nullptr : world.place(id->entity()) != nullptr;
  return is_known ? std::vector{id->entity()} : std::vector<ltm::MemoryId>();
}

/// A clock shows whole seconds, so what is said at one of them may be anywhere within it.
Period with_its_second(Period period) {
  constexpr Duration kSecond = std::chrono::seconds(1);
  if (period.is_moment() && period.to.time_since_epoch() % kSecond == Duration(0) &&
      period.to < Time::max() - kSecond)
    period.to += kSecond - Duration(1);
  return period;
}

bool is_speaker_known(const KnownFacts& facts, const std::string& lower) {
  return std::any_of(facts.words().begin(), facts.words().end(),
                     [&](const SpokenWords& words) { return lower_ascii(words.speaker) == lower; });
}

}  // namespace

Result<RecordFilter> RecordFilter::create(const Program& program, FactsAsOf& facts, DayZone zone,
                                          const InnerTime& inner) {
  RecordFilter filter(facts);
  filter.take_names(program);
  ENGRAM_RETURN_IF_ERROR(filter.take_times(program, zone, inner));
  ENGRAM_RETURN_IF_ERROR(filter.check_hand());
  return filter;
}

void RecordFilter::take_names(const Program& program) {
  for (const ProgramFilter& filter : program.filters)
    if (filter.value.program == nullptr) take_name(filter.key, filter.value.text);
}

/// Whichever of the names nothing is called, the answer is unknown.
void RecordFilter::take_entities(const std::string& text, bool is_thing) {
  const KnownWorld& world = facts_->world();
  (is_thing ? has_things_ : has_places_) = true;
  std::vector<std::string> names = names_in_list(text);
  if (names.empty()) names.push_back(text);
  for (const std::string& name : names) {
    auto found = entities_called(world, name, is_thing);
    auto& entities = is_thing ? things_ : places_;
    entities.insert(entities.end(), found.begin(), found.end());
    if (!found.empty() || !missing_.empty()) continue;
    missing_ =
        is_thing && world.knows_thing(name)
            ? fmt::format("none called {} was ever seen", printable(name))
            : fmt::format("no {} is called {}", is_thing ? "thing" : "place", printable(name));
  }
}

/// People have a left and a right hand, whatever the memory tells; of others somebody must have
/// told.
Status RecordFilter::check_hand() {
  if (hand_.empty() || hand_ == "left" || hand_ == "right" || !missing_.empty()) return {};
  const auto& executions = facts_->names().executions();
  bool is_known = std::any_of(executions.begin(), executions.end(),
                              [&](const Execution& one) { return one.hand == hand_; });
  std::vector<Time> times{facts_->now()};
  if (at_) times.push_back(at_->to);
  for (const Time time : times) {
    if (is_known) break;
    ENGRAM_ASSIGN_OR_RETURN(const auto states, facts_->things_at(time));
    is_known = std::any_of(states.begin(), states.end(),
                           [&](const ThingState& one) { return one.held_by == hand_; });
  }
  if (!is_known) missing_ = fmt::format("no hand is called {}", printable(hand_));
  return {};
}

void RecordFilter::take_name(FilterKey key, const std::string& text) {
  const std::string lower = lower_ascii(text);
  const auto miss = [&](const char* kind) {
    if (missing_.empty()) missing_ = fmt::format("no {} is called {}", kind, printable(text));
  };
  switch (key) {
    case FilterKey::kThing:
      take_entities(text, true);
      break;
    case FilterKey::kPlace:
      take_entities(text, false);
      break;
    case FilterKey::kSkill: {
      skills_ = names_in_list(lower);
      const auto& known = facts_->names().skills();
      const bool is_known = std::any_of(skills_.begin(), skills_.end(), [&](const auto& name) {
        return std::find(known.begin(), known.end(), name.substr(name.rfind('/') + 1)) !=
               known.end();
      });
      if (!is_known) miss("skill");
      break;
    }
    case FilterKey::kSpeaker:
      speakers_ = names_in_list(lower);
      for (const std::string& speaker : speakers_)
        if (!is_speaker_known(facts_->names(), speaker)) miss("person who spoke");
      break;
    case FilterKey::kHand:
      hand_ = words_of_hand(text);
      break;
    case FilterKey::kOutcome:
      outcome_ = lower;
      break;
    case FilterKey::kText:
      text_ = lower;
      break;
    case FilterKey::kKind:
      kind_ = lower;
      break;
    case FilterKey::kIsHeld:
      is_held_ = lower == "yes";
      break;
    case FilterKey::kVisible:
      is_visible_ = lower == "yes";
      break;
    default:
      break;
  }
}

Status RecordFilter::take_times(const Program& program, DayZone zone, const InnerTime& inner) {
  for (const ProgramFilter& filter : program.filters) {
    const bool is_time = filter.key == FilterKey::kDuring || filter.key == FilterKey::kAt ||
                         filter.key == FilterKey::kAfter || filter.key == FilterKey::kBefore;
    if (!is_time) continue;
    Period period;
    if (filter.value.program != nullptr) {
      ENGRAM_ASSIGN_OR_RETURN(const std::optional<Time> time, inner(*filter.value.program));
      if (!time) {
        if (missing_.empty())
          missing_ = fmt::format("there is no time '{}'", filter.value.program->to_string());
        continue;
      }
      period = {*time, *time};
    } else {
      ENGRAM_ASSIGN_OR_RETURN(period, resolve_period(filter.value.text, facts_->now(), zone));
    }
    const bool is_of_clock =
        filter.value.program == nullptr && !filter.value.text.starts_with("now");
    const Period whole = is_of_clock ? with_its_second(period) : period;
    if (filter.key == FilterKey::kAt) {
      at_ = period;
      said_at_ = whole;
    }
    if (filter.key == FilterKey::kDuring) period = whole;
    if (filter.key == FilterKey::kDuring) {
      begun_.from = std::max(begun_.from, period.from);
      begun_.to = std::min(begun_.to, period.to);
    }
    // "After 8:05" includes that minute, and "after yesterday" nothing of that day.
    const bool is_long = period.from != Time::min() && period.to != Time::max() &&
                         period.to - period.from > std::chrono::minutes(1);
    if (filter.key == FilterKey::kAfter)
      begun_.from = std::max(begun_.from, is_long ? period.to : period.from);
    if (filter.key == FilterKey::kBefore && period.from != Time::min())
      begun_.to = std::min(begun_.to, period.from - Duration(1));
  }
  const bool is_to_come = begun_.from > facts_->now() || (at_ && at_->from > facts_->now());
  if (missing_.empty() && is_to_come) missing_ = "that time has not come";
  return {};
}

bool RecordFilter::is_begun(Time time) const {
  return begun_.contains(time);
}

bool RecordFilter::is_said_at(Time time) const {
  return !said_at_ || said_at_->contains(time);
}

bool RecordFilter::has_entity(const std::optional<ltm::MemoryId>& entity, bool is_thing) const {
  if (!(is_thing ? has_things_ : has_places_)) return true;
  const auto& wanted = is_thing ? things_ : places_;
  return entity && std::find(wanted.begin(), wanted.end(), *entity) != wanted.end();
}

bool RecordFilter::has_skill(const std::string& provider, const std::string& skill) const {
  if (skills_.empty()) return true;
  const std::string name = lower_ascii(skill);
  const std::string whole = lower_ascii(provider) + "/" + name;
  return std::any_of(skills_.begin(), skills_.end(),
                     [&](const std::string& wanted) { return wanted == name || wanted == whole; });
}

bool RecordFilter::has_text(const std::string& text) const {
  return text_.empty() || lower_ascii(text).find(text_) != std::string::npos;
}

bool RecordFilter::is_speaker(const std::string& speaker) const {
  return std::find(speakers_.begin(), speakers_.end(), lower_ascii(speaker)) != speakers_.end();
}

bool RecordFilter::has_outcome(const Execution& execution) const {
  using ltm::ActionOutcome;
  if (outcome_.empty()) return true;
  // What was begun again since does not run, though no end of it is known.
  if (outcome_ == "running")
    return execution.outcome == ActionOutcome::kRunning && execution.goes_on(facts_->now());
  return fits_outcome(outcome_, execution.outcome);
}

Result<bool> RecordFilter::keeps(const Execution& execution) {
  if (!is_begun(execution.started) || !has_skill(execution.provider, execution.skill) ||
      !has_entity(execution.thing, true) || !has_entity(execution.place, false) ||
      !has_outcome(execution) || !has_text(execution.reason))
    return false;
  if (!hand_.empty() && execution.hand != hand_) return false;
  if (at_ && !execution.is_within(at_->from, at_->to)) return false;
  if (speakers_.empty()) return true;
  ENGRAM_ASSIGN_OR_RETURN(const std::string speaker, speaker_of(*facts_, execution));
  return is_speaker(speaker);
}

int RecordFilter::relation(const Execution& execution) const {
  int relation = 0;
  if (has_things_ && has_entity(execution.thing, true)) relation += 4;
  if (!skills_.empty() && has_skill(execution.provider, execution.skill)) relation += 2;
  if (has_places_ && has_entity(execution.place, false)) relation += 1;
  return relation;
}

bool RecordFilter::keeps(const SpokenWords& words) const {
  return is_begun(words.time) && has_text(words.text) && is_said_at(words.time) &&
         (speakers_.empty() || is_speaker(words.speaker));
}

bool RecordFilter::keeps(const TaskPlan& plan) const {
  if (!is_begun(plan.time) || !has_text(plan.goal) || !is_said_at(plan.time)) return false;
  const SpokenWords* words = plan.command ? facts_->words_at(*plan.command) : nullptr;
  if (!speakers_.empty() && (words == nullptr || !is_speaker(words->speaker))) return false;
  const auto leads_to = [&](bool is_thing) {
    return std::any_of(plan.steps.begin(), plan.steps.end(), [&](const PlannedStep& step) {
      return has_entity(is_thing ? step.thing : step.place, is_thing);
    });
  };
  return (!has_things_ || leads_to(true)) && (!has_places_ || leads_to(false));
}

bool RecordFilter::keeps(const RefusedRequest& refusal) const {
  return is_begun(refusal.time) && has_skill({}, refusal.skill) && has_text(refusal.reason) &&
         is_said_at(refusal.time);
}

bool RecordFilter::keeps(const DriveNote& note) const {
  return is_begun(note.time) && has_text(note.goal + " " + note.reason) &&
         (kind_.empty() || note.kind == kind_) && is_said_at(note.time);
}

Result<std::optional<SpokenWords>> words_of(FactsAsOf& facts, const Execution& execution) {
  // The plan and its command are in the index; other links must be read.
  const TaskPlan* plan = execution.plan ? facts.plan_at(*execution.plan) : nullptr;
  if (plan != nullptr && plan->command)
    if (const SpokenWords* words = facts.words_at(*plan->command)) return std::optional(*words);
  ENGRAM_ASSIGN_OR_RETURN(const auto causes, facts.causes_of(execution));
  for (const KnownFacts::Cause& cause : causes)
    if (const SpokenWords* words = facts.words_at(cause.id)) return std::optional(*words);
  return std::optional<SpokenWords>();
}

Result<std::string> speaker_of(FactsAsOf& facts, const Execution& execution) {
  ENGRAM_ASSIGN_OR_RETURN(const auto words, words_of(facts, execution));
  return words ? words->speaker : std::string();
}

}  // namespace engram::speech
