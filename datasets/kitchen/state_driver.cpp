// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>

#include "datasets/kitchen/drivers.h"
#include "datasets/kitchen/entities.h"
#include "datasets/kitchen/facts.h"
#include "datasets/kitchen/kept_commits.h"
#include "datasets/kitchen/movable_places.h"

namespace engram::datasets::kitchen {

namespace {

using DriverClock = std::chrono::steady_clock;

Time time_of_sample(const BodyDescription& body, uint64_t sample) {
  return body.start +
         std::chrono::milliseconds(1000 / RobotBus::kRate_hz) * static_cast<int64_t>(sample);
}

ltm::Commit prior_of(const BodyDescription& body) {
  ltm::Commit commit;
  const DrawingSize size{.width = body.width, .height = body.height, .samples = body.samples};
  const Lighting light{.lamp = body.lamp, .daylight = body.daylight, .warmth = body.warmth};
  add_snapshot(commit, entities::recording(), body.start,
               {facts::recording(body.seed, body.seconds, size, light)}, "simulation");
  add_snapshot(commit, entities::description(), body.start,
               {facts::description(body.lower, body.upper, body.urdf)}, "simulation");
  for (const Surface surface : {Surface::kCounter, Surface::kTable})
    add_snapshot(commit, entities::surface(surface), body.start, {facts::surface(surface)},
                 "prior");
  for (const auto all : {all_thing_classes(), movable_classes()})
    for (const ThingClass& type : all)
      add_snapshot(commit, entities::object_class(type), body.start, {facts::object_class(type)},
                   "prior");
  return commit;
}

/// Turns states into snapshots.
class StateReport {
 public:
  explicit StateReport(const BodyDescription& body) : body_(body) {}

  void add(const BodyState& state, ltm::Commit& commit) {
    const Time time = time_of_sample(body_, state.sample);
    add_snapshot(commit, entities::joints(), time,
                 {facts::joints(state.positions, state.velocities)}, "robot");
    add_snapshot(commit, entities::platform(), time,
                 {facts::platform(state.positions, state.velocities)}, "robot");
    if (state.sample % RobotBus::kObjectsEvery != 0 && !state.has_news) return;
    // An object links to the last image that is in the memory; before the first there is none.
    ltm::MemoryId image;
    if (state.images_until > 0)
      image = entities::stereo().at(time_of_sample(body_, state.images_until - 1)).instance(0);
    const facts::Links links{image, entities::joints().at(time).instance(0),
                             entities::platform().at(time).instance(0)};
    for (const SensedObject& object : state.objects) {
      const ThingClass* type = class_named(object.name);
      // A chair that leaves is told once more, where it went.
      if (type == nullptr || (is_away(object.pose) && gone_.contains(object.name))) continue;
      if (is_away(object.pose))
        gone_.insert(object.name);
      else
        gone_.erase(object.name);
      add_snapshot(commit, entities::object(*type), time,
                   {facts::object(entities::object_class(*type).at(body_.start).instance(0),
                                  object.pose, object.is_visible, object.held_by, links)},
                   "localization");
    }
  }

 private:
  const BodyDescription& body_;
  std::set<std::string> gone_{"chair", "person"};  ///< Movables that are not in the room.
};

/// The times between commits.
class Intervals {
 public:
  void note() {
    const auto now = DriverClock::now();
    if (last_ != DriverClock::time_point())
      ms_.push_back(std::chrono::duration<double, std::milli>(now - last_).count());
    last_ = now;
  }

  void tell(std::map<std::string, double>& figures) {
    if (ms_.empty()) return;
    std::ranges::sort(ms_);
    figures["interval_p50_ms"] = ms_[ms_.size() / 2];
    figures["interval_p99_ms"] = ms_[ms_.size() * 99 / 100];
    ms_.clear();
  }

 private:
  DriverClock::time_point last_;
  std::vector<double> ms_;
};

}  // namespace

Status drive_state(RobotBus& bus, const DriverOptions& options, const std::stop_token& stop) {
  ENGRAM_ASSIGN_OR_RETURN(const BodyDescription body, bus.describe());
  KeptCommits kept(options, prior_of(body), body.is_stepped);
  StateReport report(body);
  Intervals intervals;
  std::map<std::string, double> figures;
  auto told = DriverClock::now();
  for (uint64_t next = 0; !stop.stop_requested();) {
    const auto states = bus.wait(next, stop);
    if (states.status().code() == StatusCode::kCancelled) break;
    if (!states.ok()) return states.status();
    if (states->empty()) continue;
    intervals.note();
    // Only a driver that came or went on late missed some.
    if (next > 0) figures["lost"] += static_cast<double>(states->front().sample - next);
    next = states->back().sample + 1;
    ltm::Commit commit;
    for (const BodyState& state : *states) report.add(state, commit);
    const auto is_kept = kept.commit(commit, stop);
    if (is_kept.status().code() == StatusCode::kCancelled) break;
    if (!is_kept.ok()) return is_kept.status();
    figures[*is_kept ? "samples" : "lost"] += static_cast<double>(states->size());
    figures["away"] = kept.times_away();
    if (DriverClock::now() - told < options.figures_every) continue;
    told = DriverClock::now();
    intervals.tell(figures);
    options.tell(figures);
  }
  intervals.tell(figures);
  options.tell(figures);
  return {};
}

}  // namespace engram::datasets::kitchen
