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

ltm::Commit prior_of(const BodyDescription& body) {
  ltm::Commit commit;
  const Lighting light{.lamp = body.lamp, .daylight = body.daylight, .warmth = body.warmth};
  add_snapshot(commit, entities::recording(), body.start,
               {facts::recording(body.seed, body.seconds, body.size(), light)}, "simulation");
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
  explicit StateReport(const BodyDescription& body) : body_(body) {
    // At the beginning nobody has heard of a chair. Later one may have left while no driver was
    // there to tell it.
    if (body.begin == 0) gone_ = {"chair", "person"};
  }

  void add(const BodyState& state, ltm::Commit& commit) {
    const Time time = body_.time_of(state.sample);
    add_snapshot(commit, entities::joints(), time,
                 {facts::joints(state.positions, state.velocities)}, "robot");
    add_snapshot(commit, entities::platform(), time,
                 {facts::platform(state.positions, state.velocities)}, "robot");
    if (state.sample % RobotBus::kObjectsEvery != 0 && !state.has_news) return;
    // An object links to the last image that is in the memory; before the first there is none.
    ltm::MemoryId image;
    if (state.images_until > 0)
      image = entities::stereo().at(body_.time_of(state.images_until - 1)).instance(0);
    const facts::Links links{image, entities::joints().at(time).instance(0),
                             entities::platform().at(time).instance(0)};
    for (const SensedObject& object : state.objects) {
      const ThingClass* type = class_named(object.name);
      // A chair that leaves is told once more, where it went.
      if (type == nullptr || (is_away(object.pose) && gone_.contains(object.name))) continue;
      if (is_away(object.pose))
        leaving_.insert(*gone_.insert(object.name).first);
      else
        gone_.erase(object.name);
      add_snapshot(commit, entities::object(*type), time,
                   {facts::object(entities::object_class(*type).at(body_.start).instance(0),
                                  object.pose, object.is_visible, object.held_by, links)},
                   "localization");
    }
  }

  /// What was added is in the memory, or it is lost: then it does not know who left.
  void end_commit(bool is_kept) {
    if (!is_kept)
      for (const std::string& name : leaving_) gone_.erase(name);
    leaving_.clear();
  }

 private:
  const BodyDescription& body_;
  std::set<std::string> gone_;     ///< Movables of which the memory knows that they are away.
  std::set<std::string> leaving_;  ///< Those of them that are so since the last commit.
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
  std::string blocked_by;
  for (uint64_t next = body.begin; !stop.stop_requested();) {
    const auto states = bus.wait(next, stop);
    if (states.status().code() == StatusCode::kCancelled) break;
    if (!states.ok()) return states.status();
    if (states->empty()) continue;
    intervals.note();
    // The body remembers what a driver missed that died or was slow, but not for ever.
    if (const uint64_t gap = states->front().sample - next; gap > 0) {
      figures["lost"] += static_cast<double>(gap);
      options.say(fmt::format("{} samples from {} on were lost: nobody asked for them in time", gap,
                              engram::to_string(body.time_of(next))));
    }
    next = states->back().sample + 1;
    ltm::Commit commit;
    for (const BodyState& state : *states) {
      report.add(state, commit);
      if (!state.blocked_by.empty() && state.blocked_by != blocked_by)
        options.say(fmt::format("the platform stopped: the {} is in its way", state.blocked_by));
      blocked_by = state.blocked_by;
    }
    const auto is_kept = kept.commit(commit, stop);
    if (is_kept.status().code() == StatusCode::kCancelled) break;
    if (!is_kept.ok()) return is_kept.status();
    report.end_commit(*is_kept);
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
