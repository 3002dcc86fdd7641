// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what recordings of kitchens tell, read value by value.

#include <Eigen/Geometry>
#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "memory/memory.h"

namespace engram::speech::dialogues {

/// So shortly before and after a change nobody can say what was so.
inline constexpr Duration kUnclear = std::chrono::milliseconds(700);

/// One execution of a skill. All IDs are of instances.
struct LivedAction {
  ltm::MemoryId begun;
  std::optional<ltm::MemoryId> over;  ///< Nothing: the recording ended before it did.
  std::string skill;                  ///< Without its provider.
  std::string outcome = "running";    ///< "running", "success", "failure", "stop" or "lost".
  std::string reason;
  Time started{};
  std::optional<Time> ended;
  std::string thing;  ///< As it is spoken of; empty: none.
  std::string place;  ///< Empty: none.
  std::string hand;   ///< Empty: none.
  std::optional<ltm::MemoryId> plan;
  std::vector<ltm::MemoryId> stopped_by;

  [[nodiscard]] double seconds() const { return ended ? to_seconds(*ended - started) : 0; }
};

struct LivedWords {
  ltm::MemoryId id;
  Time time{};
  std::string speaker;
  std::string text;
};

struct LivedStep {
  std::string skill;
  std::string thing;
  std::string place;
};

struct LivedPlan {
  ltm::MemoryId id;
  Time time{};
  std::optional<ltm::MemoryId> command;
  std::vector<LivedStep> steps;
};

/// Where a thing was at a time.
struct LivedSight {
  ltm::MemoryId id;
  Time time{};
  Eigen::Vector3d at{0, 0, 0};  ///< Frame: world.
  bool is_visible = false;
  std::string held_by;
  std::string colour;  ///< Empty: it is not recorded.
};

struct LivedPlace {
  ltm::MemoryId id;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  double depth_m = 0;
  double width_m = 0;

  /// Whether the middle of something that stands on it is at this point. Frame: world.
  [[nodiscard]] bool carries(const Eigen::Vector3d& point) const;
};

/// Where the platform was at a time.
struct LivedStand {
  ltm::MemoryId id;
  Time time{};
  Eigen::Vector2d at{0, 0};  ///< Frame: world.
};

/// All that questions are about. Lists are in the order of time, those of several entities, too.
///
/// Threading: immutable once it is read.
struct LivedPast {
  std::vector<LivedAction> actions;
  std::vector<LivedWords> words;
  std::map<ltm::MemoryId, LivedPlan> plans;
  std::map<std::string, std::vector<LivedSight>> sights;  ///< By the spoken name of the thing.
  std::map<std::string, LivedPlace> places;               ///< By name.
  std::vector<std::string> known_things;  ///< Spoken names of all kinds, seen or not; sorted.
  std::vector<LivedStand> stands;
  std::vector<std::pair<Time, Time>> recordings;  ///< Begin and last moment of each.
  int64_t seed = 0;                               ///< Of the first recording.

  /// Errors: those of Memory::query; kNotFound if there are no recordings of kitchens;
  /// kInvalidArgument if a value is not what a kitchen records.
  static Result<LivedPast> read(Memory& memory);

  /// What was known at a time: what went on then has no end, and nothing came later. Without
  /// recordings if none had begun.
  [[nodiscard]] LivedPast until(Time now) const;

  [[nodiscard]] Time last_moment() const { return recordings.back().second; }
  /// Null: said elsewhere, or nothing.
  [[nodiscard]] const LivedWords* words_of(const ltm::MemoryId& id) const;
  [[nodiscard]] const LivedPlan* plan_of(const LivedAction& action) const;
  /// What was said that led to an action; null: nothing is known.
  [[nodiscard]] const LivedWords* command_of(const LivedAction& action) const;
  /// The last sight of a thing at or before a time, at most half a second old; null: none.
  [[nodiscard]] const LivedSight* sight_at(const std::string& thing, Time time) const;
  /// The name of the place that a thing stands on so far from the edge that nobody disputes it;
  /// empty: none, or it is held.
  [[nodiscard]] std::string place_below(const LivedSight& sight) const;
};

}  // namespace engram::speech::dialogues
