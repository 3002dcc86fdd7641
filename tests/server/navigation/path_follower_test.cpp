// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/path_follower.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/ltm/expect_status.h"
#include "tests/server/navigation/map_example.h"

namespace engram::navigation {
namespace {

using testing::map_of_obstacles;

Obstacle standing(double x, double y, double diameter, double max_speed = 0) {
  Obstacle obstacle;
  obstacle.shape = Obstacle::Shape::kCylinder;
  obstacle.pose_world_obstacle = {x, y, 0};
  obstacle.size_m = {diameter, diameter};
  obstacle.max_speed_m_s = max_speed;
  obstacle.name = "post";
  obstacle.snapshot = testing::thing_id("post").at(testing::kBegin).instance(0);
  return obstacle;
}

/// A platform that does what it is told.
struct IdealBase {
  BaseState state;

  void go(const Twist& twist, double seconds) {
    state.twist = twist;
    state.pose_world_robot =
        state.pose_world_robot.times({twist.forward_m_s * seconds, 0, twist.turn_rad_s * seconds});
  }
};

TEST(PathFollower, FollowsAWayWithinItsLimitsAndStopsAtItsGoal) {
  const std::vector<PlanarPose> path{{-3, -3, 0}, {0, -3, 0}, {0, 0, 1.57}, {3, 0, 2}};
  const DriveLimits limits;
  PathFollower follower(path, limits);
  const CostMap map = map_of_obstacles({});
  IdealBase base{{{}, {-3, -3, -2}, {}}};
  constexpr double kPeriod = 0.05;
  double farthest_off = 0;
  int steps = 0;
  while (steps < 2000) {
    const PathFollower::Step step = follower.next(base.state, map, kPeriod);
    if (step.has_arrived) break;
    EXPECT_LE(step.twist.forward_m_s, limits.max_speed_m_s + 1e-9);
    EXPECT_LE(std::abs(step.twist.turn_rad_s), limits.max_turn_rad_s + 1e-9);
    EXPECT_LE(std::abs(step.twist.forward_m_s - base.state.twist.forward_m_s),
              limits.acceleration_m_s2 * kPeriod + 1e-9);
    base.go(step.twist, kPeriod);
    farthest_off =
        std::max(farthest_off, follower.distance_m(base.state.pose_world_robot.position()));
    ++steps;
  }
  EXPECT_LT(steps, 600);
  EXPECT_LT(farthest_off, 0.25);
  EXPECT_NEAR(base.state.pose_world_robot.x_m, 3, 0.06);
  EXPECT_NEAR(base.state.pose_world_robot.y_m, 0, 0.06);
  EXPECT_NEAR(base.state.pose_world_robot.heading_rad, 2, 0.06);
}

TEST(PathFollower, TellsWhenTheRestOfItsWayIsBlocked) {
  PathFollower follower({{-3, 0, 0}, {3, 0, 0}}, {});
  EXPECT_FALSE(follower.is_blocked(map_of_obstacles({}), {-3, 0, 0}));
  EXPECT_TRUE(follower.is_blocked(map_of_obstacles({standing(1, 0.2, 0.3)}), {-3, 0, 0}));
  EXPECT_FALSE(follower.is_blocked(map_of_obstacles({standing(1, 1.2, 0.3)}), {-3, 0, 0}));
  // What it leaves behind does not block it, and neither does what it stands beside.
  EXPECT_FALSE(follower.is_blocked(map_of_obstacles({standing(-3.5, 0, 0.3)}), {-3, 0, 0}));
}

TEST(SafeSpeed, LetsTheRobotStopBeforeWhatStandsAhead) {
  const DriveLimits limits;
  for (double gap = 0.0; gap < 1; gap += 0.01) {
    const auto obstacles = {standing(limits.robot_radius_m + gap + 0.25, 0, 0.5)};
    const double speed = safe_speed({}, 0.6, 0, obstacles, limits).speed_m_s;
    const double way = speed * limits.reaction_s + speed * speed / (2 * limits.acceleration_m_s2);
    EXPECT_LE(way, std::max(0.0, gap - limits.margin_m) + 1e-9) << gap;
    if (gap > 0.35) {
      EXPECT_EQ(speed, 0.6) << gap;
    }
  }
}

TEST(SafeSpeed, KeepsMoreAwayFromWhatMayMove) {
  const DriveLimits limits;
  const std::vector<Obstacle> person{standing(1.25, 0, 0.5, 1.2)};
  const SafeSpeed safe = safe_speed({}, 0.6, 0, person, limits);
  EXPECT_LT(safe.speed_m_s, 0.4);
  EXPECT_GT(safe.speed_m_s, 0.1);
  ASSERT_TRUE(safe.held_by.has_value());
  EXPECT_EQ(safe.held_by->name, "post");
  // A person behind the robot does not hold it up, however near.
  EXPECT_EQ(safe_speed({}, 0.6, 0, {standing(-0.6, 0, 0.5, 1.2)}, limits).speed_m_s, 0.6);
  // Neither does one beside it, whom it only leaves.
  EXPECT_EQ(safe_speed({}, 0.6, 0, {standing(0, 0.6, 0.5, 1.2)}, limits).speed_m_s, 0.6);
}

TEST(DriveLimits, RefuseWhatIsNoLimit) {
  EXPECT_OK(DriveLimits{}.validate());
  EXPECT_FAILS(DriveLimits{.max_speed_m_s = 0}.validate(), StatusCode::kInvalidArgument, "limit");
  EXPECT_FAILS(DriveLimits{.reaction_s = -1}.validate(), StatusCode::kInvalidArgument, "reaction");
}

// Its platform hears late, and is as fast as before when the next command is given.
TEST(PathFollower, BrakesFromItsLastCommandAndNotFromTheSpeedBefore) {
  const DriveLimits limits;
  PathFollower follower({{-3, 0, 0}, {3, 0, 0}}, limits);
  const CostMap map = map_of_obstacles({standing(-2.2, 0, 0.3)});
  const BaseState state{{}, {-3, 0, 0}, {0.6, 0}};
  constexpr double kPeriod = 0.1;
  const double first = follower.next(state, map, kPeriod).twist.forward_m_s;
  const double second = follower.next(state, map, kPeriod).twist.forward_m_s;
  EXPECT_NEAR(first, 0.6 - limits.acceleration_m_s2 * kPeriod, 1e-9);
  EXPECT_NEAR(second, 0.6 - 2 * limits.acceleration_m_s2 * kPeriod, 1e-9);
}

}  // namespace
}  // namespace engram::navigation
