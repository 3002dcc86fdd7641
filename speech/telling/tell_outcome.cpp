// SPDX-License-Identifier: Apache-2.0
#include "speech/telling/tell_outcome.h"

#include <algorithm>
#include <map>

#include "ltm/core/printable.h"
#include "speech/telling/phrases.h"

namespace engram::speech {

namespace {

/// Executions that are told one by one; of more only how often and how they ended.
constexpr size_t kMaxTold = 5;
constexpr Duration kJustNow = std::chrono::minutes(1);

/// One teller per outcome; a method per kind of value.
class OutcomeTeller {
 public:
  OutcomeTeller(const Outcome& outcome, const KnownFacts& facts, DayZone zone)
      : outcome_(outcome), world_(facts.world()), zone_(zone) {}

  std::string operator()(answers::Unknown) const {
    std::string text = "I do not know";
    if (!outcome_.missing.empty()) text += ": " + printable(outcome_.missing);
    return text + ". I looked for " + outcome_.looked_for + ".";
  }

  std::string operator()(answers::YesNo answer) const {
    const std::string word = answer.value ? "Yes" : "No";
    if (!outcome_.steps.empty()) return fmt::format("{}. {}", word, told_steps());
    if (outcome_.executions.empty() && outcome_.states.empty() && answer.value &&
        !outcome_.words.empty())
      return fmt::format("{}. {}", word, sentence(words_phrase(outcome_.words.back())));
    if (outcome_.executions.empty() && outcome_.states.empty()) {
      const bool is_search = outcome_.program.has_step(StepKind::kExists);
      return is_search && !answer.value ? fmt::format("No. I remember no {}.", outcome_.looked_for)
                                        : word + ".";
    }
    const bool is_of_move = outcome_.program.has_step(StepKind::kWasMoved);
    if (is_of_move && answer.value && outcome_.states.size() == 2)
      return fmt::format("{}. {}", word, told_move());
    if (!outcome_.states.empty()) return fmt::format("{}. {}", word, told_state());
    return fmt::format("{}. {}", word, told_executions());
  }

  std::string operator()(answers::Count answer) const {
    const ProgramStep* last_step =
        outcome_.program.steps.empty() ? nullptr : &outcome_.program.steps.back();
    if (last_step != nullptr && last_step->kind == StepKind::kHowMany && answer.value > 0)
      return sentence(counted(static_cast<size_t>(answer.value), last_step->argument->text)) +
             (outcome_.executions.empty() ? "" : " " + told_executions());
    const std::string times = answer.value == 1   ? "Once"
                              : answer.value == 2 ? "Twice"
                                                  : std::to_string(answer.value);
    if (outcome_.executions.empty()) {
      if (answer.value == 0) return fmt::format("None: I remember no {}.", outcome_.looked_for);
      return fmt::format("{}.", answer.value);
    }
    return fmt::format("{}{}. {}", times, answer.value > 2 ? " times" : "", told_executions());
  }

  std::string operator()(answers::Moment answer) const {
    const std::string when = spoken_time(answer.value, outcome_.now, zone_);
    if (!outcome_.executions.empty())
      return sentence(
          fmt::format("{} {}", when, outcome_phrase(outcome_.executions.front(), world_)));
    if (!outcome_.words.empty())
      return sentence(fmt::format("{} {}", when, words_phrase(outcome_.words.front())));
    if (!outcome_.states.empty())
      return sentence(fmt::format("{} I saw {}", when, thing_of(outcome_.states.front())));
    return sentence(when);
  }

  std::string operator()(answers::Span answer) const {
    return sentence(spoken_span(answer.from, answer.to, outcome_.now, zone_));
  }

  std::string operator()(answers::Seconds answer) const {
    if (outcome_.executions.size() != 1) return sentence(spoken_duration(answer.value));
    return sentence(fmt::format("it took {} to {}", spoken_duration(answer.value),
                                base_phrase(outcome_.executions.front(), world_)));
  }

  std::string operator()(answers::Metres answer) const {
    return fmt::format("I drove {:.2f} m.", answer.value);
  }

  std::string operator()(const answers::Names& answer) const {
    if (!outcome_.steps.empty()) return told_steps();
    if (answer.value.empty()) return told_no_name();
    std::vector<std::string> names;
    for (const std::string& name : answer.value) names.push_back(printable(name));
    const ProgramStep* last =
        outcome_.program.steps.empty() ? nullptr : &outcome_.program.steps.back();
    const bool is_person =
        last != nullptr && (last->kind == StepKind::kWho || last->kind == StepKind::kWhoStopped);
    if (!is_person && !outcome_.states.empty() && last != nullptr && last->kind == StepKind::kWhere)
      return told_state();
    if (is_person && names.size() == 1 && !outcome_.words.empty())
      return sentence(words_phrase(outcome_.words.back()));
    const std::string what = last != nullptr && last->argument ? last->argument->text : "";
    if (what == "hand" || (last != nullptr && last->kind == StepKind::kHolder))
      return sentence(my_hands(answer.value));
    if (what == "skill" && outcome_.plans.size() == 1 && !outcome_.plans.front().steps.empty())
      return sentence("my plan was to " + steps_phrase(outcome_.plans.front().steps));
    if (what == "skill") return sentence(joined(names));
    if (what == "colour")
      return sentence(outcome_.states.size() == 1
                          ? thing_of(outcome_.states.front()) + " is " + joined(names)
                          : joined(names));
    for (std::string& name : names) name = with_article(name);
    const bool is_place = last != nullptr && (last->kind == StepKind::kWhere ||
                                              last->kind == StepKind::kFrom || what == "place");
    if (outcome_.program.source == ProgramSource::kRobot)
      return sentence("I was at " + joined(names));
    return sentence((is_place ? "at " : "") + joined(names));
  }

  std::string operator()(const answers::Events& answer) const {
    if (!answer.value.empty()) return is_of_now() ? told_present() : told_executions();
    if (outcome_.program.find(FilterKey::kAt) != nullptr && outcome_.program.filters.size() == 1)
      return "I was doing nothing.";
    return fmt::format("Nothing. I remember no {}.", outcome_.looked_for);
  }

  std::string operator()(const answers::Reason& answer) const {
    const ProgramStep* last =
        outcome_.program.steps.empty() ? nullptr : &outcome_.program.steps.back();
    if (last != nullptr && last->kind == StepKind::kSaid) {
      std::string text;
      for (const SpokenWords& words : outcome_.words)
        text += (text.empty() ? "" : " ") + sentence(words_phrase(words));
      return text.substr(0, kMaxText);
    }
    if (outcome_.words.empty() || (last != nullptr && last->kind == StepKind::kReason))
      return sentence("because " + printable(answer.value)).substr(0, kMaxText);
    std::vector<std::string> said;
    for (const SpokenWords& words : outcome_.words) said.push_back(words_phrase(words));
    return sentence("because " + joined(said)).substr(0, kMaxText);
  }

 private:
  static constexpr size_t kMaxText = 2000;

  [[nodiscard]] std::string thing_of(const ThingState& state) const {
    return "the " + printable(world_.spoken(state.id.entity()));
  }

  /// Whether the question is what goes on at its moment.
  [[nodiscard]] bool is_of_now() const {
    const Argument* at = outcome_.program.find(FilterKey::kAt);
    return at != nullptr && at->text == "now" &&
           std::all_of(outcome_.executions.begin(), outcome_.executions.end(),
                       [](const Execution& one) { return !one.ended; });
  }

  [[nodiscard]] std::string told_present() const {
    std::vector<std::string> doing;
    for (const Execution& one : outcome_.executions)
      doing.push_back(
          fmt::format("since {} I am {}", clock_of(one.started), gerund_phrase(one, world_)));
    return sentence(joined(doing));
  }

  /// "08:05:12", "yesterday at 08:05:12".
  [[nodiscard]] std::string clock_of(Time time) const {
    const std::string when = spoken_time(time, outcome_.now, zone_);
    return when.starts_with("at ") ? when.substr(3) : when;
  }

  /// That no thing, place or skill is the answer, and when that was seen, unless just now.
  [[nodiscard]] std::string told_no_name() const {
    if (!outcome_.states.empty()) return "Nothing does. " + told_state();
    const ProgramStep* last =
        outcome_.program.steps.empty() ? nullptr : &outcome_.program.steps.back();
    const bool is_place = last != nullptr && last->argument && last->argument->text == "place";
    if (outcome_.program.source != ProgramSource::kThings)
      return fmt::format("{}. I remember no {}.", is_place ? "Nowhere" : "Nothing",
                         outcome_.looked_for);
    Time seen = Time::min();
    for (const Evidence& one : outcome_.evidence)
      seen = std::max(seen, one.id.time().value_or(seen));
    if (seen == Time::min() || outcome_.now - seen < kJustNow) return "Nothing.";
    return fmt::format("Nothing, as I saw it {}.", spoken_time(seen, outcome_.now, zone_));
  }

  /// "on the table", "in my left hand"
  [[nodiscard]] std::string where_phrase(const ThingState& state) const {
    if (!state.held_by.empty()) return "in " + my_hands({state.held_by});
    if (!state.spot) return "at no place that I know";
    const KnownPlace* place = world_.under(*state.spot);
    return place != nullptr
               ? "on the " + printable(place->spoken)
               : fmt::format("at x {:.2f} m, y {:.2f} m", state.spot->x, state.spot->y);
  }

  /// Where the first thing was, and when that was seen.
  [[nodiscard]] std::string told_state() const {
    const ThingState& state = outcome_.states.front();
    const std::string when = spoken_time(state.time, outcome_.now, zone_);
    return sentence(fmt::format("{} {} was {}", when, thing_of(state), where_phrase(state)));
  }

  /// Where the thing was first, and where it was then.
  [[nodiscard]] std::string told_move() const {
    const ThingState& first = outcome_.states.front();
    const ThingState& moved = outcome_.states.back();
    return sentence(fmt::format(
        "{} {} was {}, and {} {}", spoken_time(first.time, outcome_.now, zone_), thing_of(first),
        where_phrase(first), spoken_time(moved.time, outcome_.now, zone_), where_phrase(moved)));
  }

  [[nodiscard]] std::string told_steps() const {
    return sentence("by my plan I would have gone on to " + steps_phrase(outcome_.steps));
  }

  [[nodiscard]] std::string steps_phrase(const std::vector<PlannedStep>& steps) const {
    std::vector<std::string> phrases;
    for (const PlannedStep& step : steps) phrases.push_back(base_phrase(step, world_));
    return joined(phrases);
  }

  [[nodiscard]] std::string told_executions() const {
    std::string text;
    if (outcome_.executions.size() <= kMaxTold) {
      for (const Execution& execution : outcome_.executions)
        text += (text.empty() ? "" : " ") +
                sentence(fmt::format("{} {}", spoken_time(execution.started, outcome_.now, zone_),
                                     outcome_phrase(execution, world_)));
      return text;
    }
    std::map<ltm::ActionOutcome, size_t> outcomes;
    std::map<std::string, size_t> phrases;
    for (const Execution& execution : outcome_.executions) {
      ++outcomes[execution.outcome];
      Execution without_details;
      without_details.skill = execution.skill;
      without_details.thing = execution.thing;
      ++phrases[past_phrase(without_details, world_)];
    }
    std::vector<std::string> parts;
    for (const auto& [phrase, count] : phrases) {
      if (parts.size() == 2 * kMaxTold) break;
      parts.push_back(count == 1 ? phrase : fmt::format("{} ({} times)", phrase, count));
    }
    if (parts.size() < phrases.size())
      parts.push_back(counted(phrases.size() - parts.size(), "other thing"));
    const Execution& first = outcome_.executions.front();
    const Execution& last = outcome_.executions.back();
    text = fmt::format("{} I carried out {}: I {}. {} succeeded",
                       spoken_span(first.started, last.started, outcome_.now, zone_),
                       counted(outcome_.executions.size(), "action"), joined(parts),
                       outcomes[ltm::ActionOutcome::kSuccess]);
    if (const size_t failed = outcomes[ltm::ActionOutcome::kFailure]; failed > 0)
      text += fmt::format(", {} failed", failed);
    if (const size_t stopped = outcomes[ltm::ActionOutcome::kStop]; stopped > 0)
      text += fmt::format(", {} {} stopped", stopped, stopped == 1 ? "was" : "were");
    if (const size_t endless =
            outcomes[ltm::ActionOutcome::kRunning] + outcomes[ltm::ActionOutcome::kUnknown];
        endless > 0)
      text += fmt::format(", of {} no end is known", endless);
    return sentence(std::move(text));
  }

  const Outcome& outcome_;
  const KnownWorld& world_;
  const DayZone zone_;
};

}  // namespace

std::string tell(const Outcome& outcome, const KnownFacts& facts, DayZone zone) {
  return std::visit(OutcomeTeller(outcome, facts, zone), outcome.value);
}

}  // namespace engram::speech
