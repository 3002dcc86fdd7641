// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <tuple>

#include "speech/program/program_run.h"

namespace engram::speech {

namespace {

/// More executions than that are no question about a way.
constexpr size_t kMaxDrives = 2000;
/// How long it took, or takes by now.
Duration length_of(const Execution& execution, Time now) {
  return std::min(execution.latest_end(), now) - execution.started;
}

/// What is told of an execution whose end is asked for and not known.
std::string_view unknown_end(const Execution& execution, Time now) {
  return execution.goes_on(now) ? "it has not ended" : "it is not known when it ended";
}

std::string said_by(const SpokenWords& words) {
  return fmt::format("{} said: {}", words.speaker.empty() ? "somebody" : words.speaker, words.text);
}

}  // namespace

Status ProgramRun::apply_to_executions(const ProgramStep& step) {
  switch (step.kind) {
    case StepKind::kLongest:
    case StepKind::kShortest:
      choose_by_length(step.kind == StepKind::kLongest);
      return {};
    case StepKind::kPrevious:
      go_to_neighbour(-1);
      return {};
    case StepKind::kNext:
      go_to_neighbour(1);
      return {};
    case StepKind::kEvents:
      tell_events();
      return {};
    case StepKind::kEnded:
      tell_ended();
      return {};
    case StepKind::kSpan:
      tell_span();
      return {};
    case StepKind::kHowLong:
      tell_how_long();
      return {};
    case StepKind::kHowFar:
      return tell_how_far();
    case StepKind::kWhere:
      tell_where_executed();
      return {};
    case StepKind::kFrom:
      return tell_from();
    case StepKind::kWhy:
      return tell_why();
    case StepKind::kReason:
      tell_reason();
      return {};
    case StepKind::kWhoStopped:
      tell_who_stopped();
      return {};
    case StepKind::kSucceeded:
      tell_succeeded();
      return {};
    case StepKind::kRetried:
      tell_retried();
      return {};
    case StepKind::kInstead:
    case StepKind::kInsteadNext:
    case StepKind::kInsteadWhere:
    case StepKind::kInsteadHas:
      tell_instead(step);
      return {};
    default:
      return invalid_argument("program: {} have no step {}", name_of(program_.source),
                              name_of(step.kind));
  }
}

/// Keeps the longest or the shortest of which that is known. What goes on is the longest where it
/// takes so long by now already, and never the shortest.
void ProgramRun::choose_by_length(bool is_longest) {
  std::vector<Execution>& executions = outcome_.executions;
  const auto rank = [&](const Execution& one) {
    const Duration length = length_of(one, now_);
    const bool is_known = one.has_known_end() || one.goes_on(now_);
    return is_longest ? std::tuple(!is_known, false, -length)
                      : std::tuple(!is_known, one.goes_on(now_), length);
  };
  const auto found =
      std::min_element(executions.begin(), executions.end(),
                       [&](const Execution& a, const Execution& b) { return rank(a) < rank(b); });
  executions = std::vector<Execution>{*found};
}

void ProgramRun::tell_events() {
  answers::Events events;
  for (const Execution& execution : outcome_.executions) {
    events.value.push_back(execution.start_id);
    outcome_.cite(execution.start_id, "started");
  }
  outcome_.value = std::move(events);
}

void ProgramRun::tell_ended() {
  const Execution& last = outcome_.executions.back();
  outcome_.cite(last);
  if (!last.has_known_end()) miss(std::string(unknown_end(last, now_)));
  outcome_.value = answers::Moment{last.ended.value_or(now_)};
}

void ProgramRun::tell_succeeded() {
  const Execution& last = outcome_.executions.back();
  outcome_.cite(last);
  // What was lost did not do what it was to do, as far as anybody knows.
  if (!last.ended) miss(std::string(unknown_end(last, now_)));
  outcome_.value = answers::YesNo{last.outcome == ltm::ActionOutcome::kSuccess};
}

/// The execution right before the first of these, or right after the last.
void ProgramRun::go_to_neighbour(int by) {
  const std::vector<const Execution*>& all = facts_.executions();
  const Execution beside = by < 0 ? outcome_.executions.front() : outcome_.executions.back();
  // They are in the order of their starts, and IDs are compared only where these are equal.
  const auto here = std::find_if(all.begin(), all.end(), [&](const Execution* execution) {
    return execution->started == beside.started && execution->start_id == beside.start_id;
  });
  const bool has_one = by < 0 ? here != all.begin() : std::next(here) != all.end();
  if (!has_one) {
    miss(by < 0 ? "nothing was done before it" : "nothing was done after it");
    return;
  }
  outcome_.cite(beside.start_id, "beside it");
  outcome_.executions = std::vector<Execution>{**std::next(here, by)};
}

/// From the start of the first to the end of whichever ended last.
void ProgramRun::tell_span() {
  const std::vector<Execution>& executions = outcome_.executions;
  const Execution* last = &executions.front();
  for (const Execution& execution : executions) {
    if (!execution.has_known_end()) miss(std::string(unknown_end(execution, now_)));
    if (execution.ended >= last->ended) last = &execution;
  }
  outcome_.cite(executions.front());
  outcome_.cite(*last);
  outcome_.value = answers::Span{executions.front().started, last->ended.value_or(now_)};
}

void ProgramRun::tell_how_long() {
  Duration length{};
  for (const Execution& execution : outcome_.executions) {
    if (!execution.has_known_end()) {
      miss(std::string(unknown_end(execution, now_)));
      return;
    }
    length += *execution.ended - execution.started;
    outcome_.cite(execution);
  }
  outcome_.value = answers::Seconds{to_seconds(length)};
}

Status ProgramRun::tell_how_far() {
  if (outcome_.executions.size() > kMaxDrives) {
    miss("there are too many drives to add up");
    return {};
  }
  double length = 0;
  bool is_known = false;
  for (const Execution& execution : outcome_.executions) {
    // What goes on has come so far by now.
    if (!execution.has_known_end() && !execution.goes_on(now_)) {
      miss(std::string(unknown_end(execution, now_)));
      return {};
    }
    ENGRAM_ASSIGN_OR_RETURN(const auto way,
                            facts_.way_of_robot(execution.started, execution.latest_end()));
    if (!way) continue;
    is_known = true;
    length += way->length_m;
    outcome_.cite(execution);
    for (const ltm::MemoryId& end : way->ends) outcome_.cite(end, "robot");
  }
  if (!is_known) miss("the memory has no way of the robot then");
  outcome_.value = answers::Metres{length};
  return {};
}

void ProgramRun::tell_where_executed() {
  std::vector<std::string> names;
  for (const Execution& execution : outcome_.executions) {
    if (!execution.place) continue;
    names.push_back(facts_.world().spoken(*execution.place));
    outcome_.cite(execution);
  }
  if (names.empty()) miss("no place is told of it");
  outcome_.value = names_of(std::move(names));
}

/// Where the thing was when it was taken; of a drive, where the robot was when it began.
Status ProgramRun::tell_from() {
  std::vector<std::string> names;
  const std::vector<Execution> executions = outcome_.executions;
  for (const Execution& execution : executions) {
    const KnownPlace* place = nullptr;
    if (execution.thing && !execution.hand.empty()) {
      ENGRAM_ASSIGN_OR_RETURN(const auto state,
                              facts_.thing_at(*execution.thing, execution.started));
      if (state && state->spot && state->held_by.empty()) {
        place = facts_.world().under(*state->spot);
        outcome_.cite(state->id, "thing");
      }
    } else {
      ENGRAM_ASSIGN_OR_RETURN(const auto robot, facts_.robot_at(execution.started));
      if (robot) {
        place = facts_.world().beside(robot->spot, kAtPlace_m);
        outcome_.cite(robot->id, "robot");
      }
    }
    outcome_.cite(execution);
    if (place != nullptr) names.push_back(place->spoken);
  }
  if (names.empty()) miss("the place from which it began has no name");
  outcome_.value = names_of(std::move(names));
  return {};
}

/// Follows links from each execution; each has a cause of its own.
Status ProgramRun::tell_why() {
  answers::Reason reason;
  for (const Execution& execution : outcome_.executions) {
    ENGRAM_ASSIGN_OR_RETURN(const auto causes, facts_.causes_of(execution));
    outcome_.cite(execution.start_id, "started");
    for (const KnownFacts::Cause& cause : causes) {
      const SpokenWords* words = facts_.words_at(cause.id);
      const TaskPlan* plan = facts_.plan_at(cause.id);
      outcome_.cite(cause.id, words != nullptr ? "words" : plan != nullptr ? "plan" : "request");
      if (std::find(reason.links.begin(), reason.links.end(), cause.id) == reason.links.end()) {
        reason.links.push_back(cause.id);
        if (words != nullptr) outcome_.words.push_back(*words);
        if (plan != nullptr) outcome_.plans.push_back(*plan);
      }
    }
    if (outcome_.evidence.size() >= Outcome::kMaxEvidence) break;
  }
  if (reason.links.empty()) {
    miss("no link says why");
    return {};
  }
  for (const SpokenWords& words : outcome_.words)
    reason.value += (reason.value.empty() ? "" : " ") + said_by(words);
  if (reason.value.empty() && !outcome_.plans.empty())
    reason.value = "it was planned: " + outcome_.plans.front().goal;
  if (reason.value.empty()) reason.value = "it was requested";
  outcome_.value = std::move(reason);
  return {};
}

/// What was measured at the end, and what stopped it.
void ProgramRun::tell_reason() {
  answers::Reason reason;
  const auto add = [&](const std::string& text, const ltm::MemoryId& id, const char* role) {
    if (!text.empty()) reason.value += (reason.value.empty() ? "" : "; ") + text;
    reason.links.push_back(id);
    outcome_.cite(id, role);
  };
  for (const RefusedRequest& refusal : refusals_) add(refusal.reason, refusal.id, "refusal");
  for (const DriveNote& note : drives_) {
    add(note.reason, note.id, "drive");
    for (const ltm::MemoryId& thing : note.blocked_by) outcome_.cite(thing, "in the way");
  }
  for (const Execution& execution : outcome_.executions) {
    if (!execution.end_id) continue;
    add(execution.reason, *execution.end_id, "ended");
    for (const ltm::MemoryId& id : execution.stopped_by) {
      const SpokenWords* words = facts_.words_at(id);
      add(words == nullptr ? "" : said_by(*words), id, words == nullptr ? "stopped it" : "words");
      if (words != nullptr) outcome_.words.push_back(*words);
    }
    outcome_.cite(execution.start_id, "started");
  }
  if (reason.value.empty()) miss("no reason is told of it");
  outcome_.value = std::move(reason);
}

void ProgramRun::tell_who_stopped() {
  std::vector<std::string> names;
  for (const Execution& execution : outcome_.executions)
    for (const ltm::MemoryId& id : execution.stopped_by) {
      const SpokenWords* words = facts_.words_at(id);
      if (words == nullptr || words->speaker.empty()) continue;
      names.push_back(words->speaker);
      outcome_.words.push_back(*words);
      outcome_.cite(id, "words");
      if (execution.end_id) outcome_.cite(*execution.end_id, "ended");
    }
  if (names.empty()) miss("nobody's words stopped it");
  outcome_.value = names_of(std::move(names));
}

}  // namespace engram::speech
