// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ltm/core/time.h"
#include "server/navigation/cost_map.h"

namespace engram::navigation {

/// A way, or why there is none.
struct FoundPath {
  std::string reason;                ///< Why there is none, in words; empty where there is one.
  std::vector<Obstacle> blocked_by;  ///< What is in the way, the next one first.
  bool is_trapped = false;           ///< There is none because the robot cannot leave where it is.
  /// Corners from start to goal, each with the direction in which the robot comes to it, the goal
  /// with its own.
  std::vector<PlanarPose> path;
  double length_m = 0;

  [[nodiscard]] bool is_found() const { return !path.empty(); }
};

/// Plans ways of a round robot on a cost map, by OMPL's RRTConnect.
///
/// A robot that is a disc touches nothing where the map is below kInscribedCost, whatever its
/// heading, so a look at one cell is an exact test and no library of collisions could tell more.
/// Whether start and goal hang together is known from the map before anything is searched, so that
/// "there is no way" is proven and not a matter of time.
/// Threading: const-parallel; searches take turns.
class PathPlanner {
 public:
  struct Options {
    uint32_t seed = 1;  ///< Equal seeds give equal ways; needs more than 0.
    /// The shortest way of so many is taken; one costs some milliseconds. A single one goes around
    /// the wrong side of things now and then, and is a fifth longer than it need be.
    uint32_t tries = 8;
    Duration time_limit = std::chrono::seconds(1);
    /// A way through cells that are cheaper than the first of these is preferred; where there is
    /// none the next ones are tried, and last all that are free. Each step costs a look at the map.
    std::vector<uint8_t> preferred_below = {100, 180};
    /// How far a start that is too near to an obstacle may be from where it is free. Unit: m.
    double way_out_m = 0.7;
    /// A robot that cannot get farther than this from where it is is trapped. Unit: m.
    double trapped_m = 1.5;

    [[nodiscard]] Status validate() const;
  };

  /// Errors: kInvalidArgument if `options` do not validate.
  static Result<PathPlanner> create(const Options& options);

  [[nodiscard]] FoundPath plan(const CostMap& map, const PlanarPose& start,
                               const PlanarPose& goal) const;

  [[nodiscard]] const Options& options() const { return options_; }

 private:
  explicit PathPlanner(Options options) : options_(std::move(options)) {}

  const Options options_;
};

}  // namespace engram::navigation
