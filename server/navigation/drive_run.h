// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: one drive, from its first plan to its last event.

#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "server/navigation/driver.h"
#include "server/navigation/path_follower.h"

namespace engram::navigation {

/// A way to the best of the places that a goal allows, or why there is none.
struct ChosenPath {
  FoundPath found;
  PlanarPose goal;
  ltm::MemoryId location;
};

/// `before` is the place that was chosen before: it is kept where it is still free, so that a robot
/// does not change its mind at each step of a person.
ChosenPath choose_path(Memory& memory, const PathPlanner& planner, const CostMap& map,
                       const DriveRequest& request, const PlanarPose& robot,
                       const std::optional<PlanarPose>& before = {});

/// One drive.
///
/// Threading: one thread.
class DriveRun {
 public:
  DriveRun(Driver& driver, const DriveRequest& request, DriveBase& base,
           const std::stop_token& stop, const Driver::Report& report);

  Result<DriveOutcome> go();

 private:
  /// Reads the base and the newest map.
  Status look();
  /// Plans until a map is there that agrees with the objects. Returns whether there is a way.
  Result<bool> plan_first();
  /// One command to the base. Returns whether the drive goes on.
  Result<bool> go_on();
  Result<bool> replan();
  /// Whether the map is still that of the objects, or will be soon.
  Result<bool> is_map_kept();
  /// What to do while nothing moves: wait, and give up at last.
  Result<bool> wait_or_give_up(const FoundPath& blocked);

  Status commit_plan(const ChosenPath& chosen);
  Status commit_event(::navigation::EventKind kind, const std::string& reason,
                      const std::vector<Obstacle>& blocked_by = {});
  /// Stops, waits until the robot rests, and commits the last event.
  Result<bool> end(::navigation::EventKind kind, const std::string& reason,
                   const std::vector<Obstacle>& blocked_by = {});

  Driver& driver_;
  const DriveRequest request_;
  DriveBase& base_;
  const std::stop_token stop_;
  const Driver::Report report_;

  BaseState state_;
  std::shared_ptr<const CostMap> map_;
  std::unique_ptr<PathFollower> follower_;
  std::optional<PlanarPose> goal_;
  DriveOutcome outcome_;
  Time started_{};
  Time planned_{};                 ///< When it last planned.
  Time moved_{};                   ///< When it last came on.
  std::optional<Time> blocked_{};  ///< Since when no way leads on.
  std::optional<Eigen::Vector2d> here_{};
  std::optional<Obstacle> held_by_{};
  ltm::MemoryId looked_at_;  ///< The map that the way was compared with.
  Time checked_{};           ///< When the map was last compared with the objects.
  ltm::MemoryId stale_map_;  ///< The map that was stale then.
  std::string stale_;        ///< What was newer.
};

}  // namespace engram::navigation
