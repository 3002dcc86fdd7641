// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "speech/program/program_run.h"

namespace engram::speech {

namespace {

bool is_seen(const ThingState& state) {
  return state.is_visible.value_or(false);
}

/// What was in sight so long ago is not in sight now: nobody told that it no longer is.
constexpr Duration kStaysInSight = std::chrono::seconds(5);

/// What is so far from where it was at first was moved: less is a push, or an error of what saw it.
constexpr double kMoved_m = 0.3;

bool has_spot(const ThingState& state) {
  return state.spot.has_value();
}

double metres_between(const Spot& a, const Spot& b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

bool is_among(const std::vector<ltm::MemoryId>& entities, const ltm::MemoryId& entity) {
  return std::find(entities.begin(), entities.end(), entity) != entities.end();
}

}  // namespace

Time ProgramRun::moment_of(const RecordFilter& filter) const {
  return filter.at() ? std::min(filter.at()->to, now_) : now_;
}

/// In a span what was in sight at any time of it.
bool ProgramRun::is_in_sight(const ThingState& state, const RecordFilter& filter) const {
  return is_seen(state) && (has_span() || moment_of(filter) - state.time <= kStaysInSight);
}

Status ProgramRun::collect_things(RecordFilter& filter) {
  const KnownWorld& world = facts_.world();
  // A step that seeks the state in which a thing was seen reads it itself.
  for (const ProgramStep& step : program_.steps)
    if (step.kind == StepKind::kFirstSeen || step.kind == StepKind::kLastSeen) return {};
  const Time at = moment_of(filter);
  std::vector<ThingState> states;
  if (has_span()) {
    // What was seen at any time of a span, or else what was told of it then.
    const bool seeks_unseen = filter.is_visible() == false;
    for (const KnownThing& thing : world.things()) {
      if (!thing.entity || (filter.has_things() && !is_among(filter.things(), *thing.entity)))
        continue;
      ENGRAM_ASSIGN_OR_RETURN(auto seen, facts_.last_state(*thing.entity, filter.begun().from,
                                                           filter.begun().to, is_seen));
      if (!seen && seeks_unseen) {
        ENGRAM_ASSIGN_OR_RETURN(
            seen, facts_.last_state(*thing.entity, filter.begun().from, filter.begun().to,
                                    [](const ThingState&) { return true; }));
      }
      if (seen) states.push_back(*std::move(seen));
    }
    if (states.empty()) {
      ENGRAM_RETURN_IF_ERROR(look_at_things(filter, filter.begun().to));
    }
  } else if (filter.has_things()) {
    for (const ltm::MemoryId& thing : filter.things()) {
      ENGRAM_ASSIGN_OR_RETURN(auto state, facts_.thing_at(thing, at));
      if (state) states.push_back(*std::move(state));
    }
  } else {
    ENGRAM_ASSIGN_OR_RETURN(states, facts_.things_at(at));
  }
  looked_at_.insert(looked_at_.end(), states.begin(), states.end());
  for (ThingState& state : states) {
    if (filter.is_held() && *filter.is_held() == state.held_by.empty()) continue;
    if (filter.is_visible() && *filter.is_visible() != is_in_sight(state, filter)) continue;
    if (!filter.hand().empty() && state.held_by != filter.hand()) continue;
    // Neither on a place nor in a hand: it is not told where it is.
    is_place_untold_ = is_place_untold_ || (filter.has_things() && filter.has_places() &&
                                            !state.spot && state.held_by.empty());
    if (filter.has_places()) {
      const KnownPlace* place =
          state.spot && state.held_by.empty() ? world.under(*state.spot) : nullptr;
      if (place == nullptr || !is_among(filter.places(), place->entity)) continue;
    }
    outcome_.states.push_back(std::move(state));
  }
  return {};
}

/// Takes the states of the things that are asked about, or of all, for a time at which none fits.
Status ProgramRun::look_at_things(const RecordFilter& filter, Time at) {
  ENGRAM_ASSIGN_OR_RETURN(looked_at_, facts_.things_at(at));
  std::erase_if(looked_at_, [&](const ThingState& state) {
    return filter.has_things() && !is_among(filter.things(), state.id.entity());
  });
  return {};
}

Status ProgramRun::collect_robot(const RecordFilter& filter) {
  const Time at = moment_of(filter);
  ENGRAM_ASSIGN_OR_RETURN(robot_, facts_.robot_at(at));
  // A state of an hour ago tells nothing about now.
  if (robot_ && at - robot_->time > std::chrono::hours(1)) robot_.reset();
  if (!robot_) miss("the memory has no place of the robot then");
  return {};
}

/// The state of the things when one of them was first or last in sight.
Status ProgramRun::seek_seen(bool is_last, const RecordFilter& filter) {
  std::optional<ThingState> best;
  for (const KnownThing& thing : facts_.world().things()) {
    if (!thing.entity || (filter.has_things() && !is_among(filter.things(), *thing.entity)))
      continue;
    const auto& [from, to] = filter.begun();
    auto seen = is_last ? facts_.last_state(*thing.entity, from, to, is_seen)
                        : facts_.first_state(*thing.entity, from, to, is_seen);
    ENGRAM_RETURN_IF_ERROR(seen.status());
    if (!*seen) continue;
    if (!best || (is_last ? best->time < (*seen)->time : best->time > (*seen)->time))
      best = **std::move(seen);
  }
  if (!best) {
    miss("it was never in sight");
    return {};
  }
  outcome_.states = std::vector<ThingState>{*std::move(best)};
  return {};
}

Status ProgramRun::apply_to_things(const ProgramStep& step, const RecordFilter& filter) {
  switch (step.kind) {
    case StepKind::kWhere:
      if (program_.source == ProgramSource::kRobot)
        tell_where_robot();
      else
        tell_where_things();
      return {};
    case StepKind::kHolder:
      tell_holder();
      return {};
    case StepKind::kIsVisible:
      tell_visible(filter);
      return {};
    case StepKind::kWasMoved:
      return tell_moved(filter);
    default:
      return invalid_argument("program: {} have no step {}", name_of(program_.source),
                              name_of(step.kind));
  }
}

void ProgramRun::tell_where_things() {
  const KnownWorld& world = facts_.world();
  std::vector<std::string> names;
  for (const ThingState& state : outcome_.states) {
    outcome_.cite(state);
    if (!state.held_by.empty()) {
      names.push_back(spoken_hand(state.held_by));
      continue;
    }
    const KnownPlace* place = state.spot ? world.under(*state.spot) : nullptr;
    if (place == nullptr) continue;
    names.push_back(place->spoken);
    outcome_.cite(place->evidence, "place");
  }
  if (names.empty()) miss("it was at no place that has a name");
  outcome_.value = names_of(std::move(names));
}

void ProgramRun::tell_where_robot() {
  const KnownPlace* place = facts_.world().beside(robot_->spot, kAtPlace_m);
  if (place == nullptr) {
    miss(fmt::format("the robot was at x {:.2f} m, y {:.2f} m, near no place that has a name",
                     robot_->spot.x, robot_->spot.y));
    return;
  }
  outcome_.cite(robot_->id, "robot");
  outcome_.cite(place->evidence, "place");
  // Where it drove to last says the same in other words.
  const Execution* last = nullptr;
  for (const Execution* execution : facts_.executions())
    if (execution->ended && *execution->ended <= robot_->time && execution->place == place->entity)
      last = execution;
  if (last != nullptr) outcome_.cite(*last);
  outcome_.value = answers::Names{{place->spoken}};
}

/// Whether the robot was at one of the places that the filters name.
void ProgramRun::tell_is_at(StepKind kind, const RecordFilter& filter) {
  const KnownPlace* place = facts_.world().beside(robot_->spot, kAtPlace_m);
  const bool is_there =
      filter.has_places() ? place != nullptr && is_among(filter.places(), place->entity) : true;
  const auto is_somewhere = [this](const ltm::MemoryId& entity) {
    const KnownPlace* named = facts_.world().place(entity);
    return named != nullptr && named->spot.has_value();
  };
  if (!is_there && !std::all_of(filter.places().begin(), filter.places().end(), is_somewhere)) {
    miss("it is not told where that place is");
    return;
  }
  outcome_.cite(robot_->id, "robot");
  if (place != nullptr) outcome_.cite(place->evidence, "place");
  if (kind == StepKind::kCount)
    outcome_.value = answers::Count{is_there ? 1 : 0};
  else
    outcome_.value = answers::YesNo{is_there == (kind == StepKind::kExists)};
}

/// The hands that hold the things; no name where none does.
void ProgramRun::tell_holder() {
  std::vector<std::string> names;
  for (const ThingState& state : outcome_.states) {
    if (!state.held_by.empty()) names.push_back(state.held_by);
    outcome_.cite(state);
  }
  outcome_.value = names_of(std::move(names));
}

void ProgramRun::tell_visible(const RecordFilter& filter) {
  bool is_visible = false;
  for (const ThingState& state : outcome_.states) {
    is_visible = is_visible || is_in_sight(state, filter);
    outcome_.cite(state);
  }
  outcome_.value = answers::YesNo{is_visible};
}

/// Whether one of the things was far from where it was first.
Status ProgramRun::tell_moved(const RecordFilter& filter) {
  const auto& [from, to] = filter.begun();
  const std::vector<ThingState> things = std::move(outcome_.states);
  outcome_.states.clear();
  bool is_told = false;
  for (const ThingState& thing : things) {
    const ltm::MemoryId entity = thing.id.entity();
    ENGRAM_ASSIGN_OR_RETURN(const auto first, facts_.first_state(entity, from, to, has_spot));
    if (!first) continue;
    is_told = true;
    outcome_.cite(*first);
    const auto is_elsewhere = [&first](const ThingState& state) {
      return state.spot && metres_between(*state.spot, *first->spot) >= kMoved_m;
    };
    ENGRAM_ASSIGN_OR_RETURN(const auto moved, facts_.last_state(entity, from, to, is_elsewhere));
    const ThingState& last = moved ? *moved : thing;
    outcome_.cite(last);
    outcome_.states.push_back(last);
    if (!moved) continue;
    outcome_.states = {*first, last};
    outcome_.value = answers::YesNo{true};
    return {};
  }
  outcome_.value = answers::YesNo{false};
  if (!is_told) tell_moved_by_deeds(things);
  return {};
}

/// Where no place of the things is told, what was done with them tells that they were moved, but
/// not that they were not.
void ProgramRun::tell_moved_by_deeds(const std::vector<ThingState>& things) {
  for (const Execution* execution : facts_.executions()) {
    if (!execution->thing || execution->outcome != ltm::ActionOutcome::kSuccess) continue;
    const bool is_asked = std::any_of(things.begin(), things.end(), [&](const ThingState& thing) {
      return thing.id.entity() == *execution->thing;
    });
    if (!is_asked) continue;
    outcome_.cite(*execution);
    outcome_.executions.push_back(*execution);
  }
  if (outcome_.executions.empty()) miss("it is not told where it was");
  outcome_.value = answers::YesNo{true};
}

}  // namespace engram::speech
