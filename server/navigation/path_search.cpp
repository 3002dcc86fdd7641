// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/path_search.h"

#include <ompl/base/MotionValidator.h>
#include <ompl/base/PlannerTerminationCondition.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include "ltm/core/mutex.h"

namespace engram::navigation {

namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

Eigen::Vector2d point_of(const ob::State* state) {
  const auto* values = state->as<ob::RealVectorStateSpace::StateType>()->values;
  return {values[0], values[1]};
}

/// A line is free where all cells that it crosses are. OMPL's own validator looks at points of it,
/// and may step over a corner.
class CellValidator : public ob::MotionValidator {
 public:
  CellValidator(const ob::SpaceInformationPtr& information, const FreeSpace& space,
                const PlanarPose& origin)
      : ob::MotionValidator(information), space_(space), origin_(origin) {}

  bool checkMotion(const ob::State* a, const ob::State* b) const override {
    return space_.is_passable(origin_.outward(point_of(a)), origin_.outward(point_of(b)));
  }

  bool checkMotion(const ob::State* a, const ob::State* b,
                   std::pair<ob::State*, double>& last_valid) const override {
    if (checkMotion(a, b)) return true;
    if (last_valid.first != nullptr) si_->copyState(last_valid.first, a);
    last_valid.second = 0;
    return false;
  }

 private:
  const FreeSpace& space_;
  const PlanarPose origin_;
};

double length_m(const std::vector<Eigen::Vector2d>& corners) {
  double length = 0;
  for (size_t i = 1; i < corners.size(); ++i) length += (corners[i] - corners[i - 1]).norm();
  return length;
}

/// Leaves out corners between which the straight line is free.
std::vector<Eigen::Vector2d> without_needless_corners(const FreeSpace& space,
                                                      std::vector<Eigen::Vector2d> corners) {
  std::vector<Eigen::Vector2d> kept{corners.front()};
  for (size_t at = 0; at + 1 < corners.size();) {
    size_t next = corners.size() - 1;
    while (next > at + 1 && !space.is_passable(corners[at], corners[next])) --next;
    kept.push_back(corners[next]);
    at = next;
  }
  return kept;
}

}  // namespace

std::optional<std::vector<Eigen::Vector2d>> search_path(const FreeSpace& space,
                                                        const Eigen::Vector2d& start,
                                                        const Eigen::Vector2d& goal,
                                                        const SearchLimits& limits) {
  if (space.is_passable(start, goal)) return std::vector<Eigen::Vector2d>{start, goal};
  // OMPL draws the seeds of all its generators from one of the process. Searches take turns, and
  // each begins with its own seed. It guards no member.
  static Mutex one_at_a_time;
  const MutexLock lock(one_at_a_time);
  ompl::msg::noOutputHandler();

  const GridFrame& frame = space.map().frame;
  const PlanarPose& origin = frame.pose_world_map;
  auto plane = std::make_shared<ob::RealVectorStateSpace>(2);
  ob::RealVectorBounds bounds(2);
  bounds.setLow(0);
  bounds.setHigh(0, frame.columns * frame.resolution_m);
  bounds.setHigh(1, frame.rows * frame.resolution_m);
  plane->setBounds(bounds);
  auto information = std::make_shared<ob::SpaceInformation>(plane);
  information->setStateValidityChecker(
      [&](const ob::State* state) { return space.is_passable(origin.outward(point_of(state))); });
  information->setMotionValidator(std::make_shared<CellValidator>(information, space, origin));
  information->setup();
  const auto state_of = [&](const Eigen::Vector2d& point) {
    ob::ScopedState<ob::RealVectorStateSpace> state(plane);
    const Eigen::Vector2d inside = origin.inward(point);
    state[0] = inside.x();
    state[1] = inside.y();
    return state;
  };

  const SteadyTime deadline = steady_now() + limits.time_limit;
  std::optional<std::vector<Eigen::Vector2d>> shortest;
  for (uint32_t i = 0; i < limits.tries && steady_now() < deadline; ++i) {
    ompl::RNG::setSeed(limits.seed + i);
    auto problem = std::make_shared<ob::ProblemDefinition>(information);
    problem->setStartAndGoalStates(state_of(start), state_of(goal));
    og::RRTConnect planner(information);
    planner.setProblemDefinition(problem);
    planner.setup();
    planner.solve(ob::PlannerTerminationCondition([&] { return steady_now() > deadline; }));
    if (!problem->hasExactSolution()) continue;
    og::PathGeometric path(*problem->getSolutionPath()->as<og::PathGeometric>());
    og::PathSimplifier(information).simplifyMax(path);
    std::vector<Eigen::Vector2d> corners;
    for (const ob::State* state : path.getStates())
      corners.push_back(origin.outward(point_of(state)));
    // They went to the frame of the map and back.
    corners.front() = start;
    corners.back() = goal;
    corners = without_needless_corners(space, std::move(corners));
    if (!shortest || length_m(corners) < length_m(*shortest)) shortest = std::move(corners);
  }
  return shortest;
}

}  // namespace engram::navigation
