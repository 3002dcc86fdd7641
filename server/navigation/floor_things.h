// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ltm/memory/query.h"
#include "ltm/memory/snapshot.h"
#include "server/navigation/map_rules.h"

namespace engram::navigation {

/// Knows what stands on the floor, from the snapshots of objects, furniture and their classes.
///
/// A thing blocks the floor unless it is held, ignored by name, lower than MapRules::min_height_m,
/// begins above MapRules::max_height_m, or stands on a surface. What should block it and cannot,
/// because its place or its size is not known, is left out with a reason.
/// Threading: one thread.
class FloorThings {
 public:
  /// What became of a thing.
  struct Change {
    ltm::MemoryId entity;
    std::optional<Obstacle> obstacle;  ///< Empty: it blocks nothing now.
  };

  /// Errors: those of MapRules::validate.
  static Result<FloorThings> create(MapRules rules);

  /// What to ask and to subscribe to.
  [[nodiscard]] std::vector<std::string> names() const;

  /// Learns of a snapshot; one that is not newer than what is known of its entity is ignored.
  /// Returns whether it is of a thing or class that counts here.
  bool take(const ltm::Snapshot& snapshot);

  /// What changed its place since the last call, or is left out for another reason.
  [[nodiscard]] std::vector<Change> take_changes();

  /// The obstacles, in the order of their entities, with their last snapshots.
  [[nodiscard]] std::vector<Obstacle> obstacles() const;
  [[nodiscard]] std::vector<LeftOutThing> left_out() const;

  /// The time of the last snapshot that is known of an entity.
  [[nodiscard]] std::optional<Time> time_of(const ltm::MemoryId& entity) const;

  /// The times of all of them, things and classes.
  [[nodiscard]] std::map<ltm::MemoryId, Time> times() const;

  /// The newest time of a thing; the epoch where nothing is known.
  [[nodiscard]] Time newest() const { return newest_; }

 private:
  struct Known {
    const ObstacleSource* source = nullptr;
    ltm::MemoryId snapshot;
    Time time{};
    idf::Data data;
    std::optional<ltm::MemoryId> object_class{};
    std::optional<Obstacle> obstacle{};
    double top_m = 0;  ///< Of a surface.
    std::string left_out{};
  };
  struct Outline;

  FloorThings(MapRules rules, std::vector<ltm::Query> queries, ltm::Query classes);

  /// Says anew where a thing is. Returns whether it is elsewhere or of another height than before.
  bool look_at(const ltm::MemoryId& entity, Known& thing);
  Result<std::optional<Obstacle>> obstacle_of(const ltm::MemoryId& entity, Known& thing) const;
  Result<Outline> outline_of(const Known& thing) const;
  [[nodiscard]] bool stands_on_surface(const Outline& outline) const;
  [[nodiscard]] double max_speed_of(const std::string& name) const;

  MapRules rules_;
  std::vector<ltm::Query> queries_;  ///< One for each source.
  std::optional<ltm::Query> classes_query_;
  std::vector<ltm::NamePattern> ignored_;
  std::vector<ltm::NamePattern> speed_names_;
  std::map<ltm::MemoryId, Known> things_;
  std::map<ltm::MemoryId, std::pair<Time, idf::Data>> classes_;
  std::set<ltm::MemoryId> changed_;
  Time newest_{};
};

}  // namespace engram::navigation
