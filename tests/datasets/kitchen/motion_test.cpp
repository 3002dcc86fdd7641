// SPDX-License-Identifier: Apache-2.0
// How the robot moves, and what it is told to do.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "datasets/kitchen/kinematics.h"
#include "datasets/kitchen/script.h"
#include "datasets/kitchen/stance.h"
#include "datasets/kitchen/trajectory.h"

namespace engram::datasets::kitchen {
namespace {

constexpr DrawingSize kSmall{.width = 32, .height = 32, .samples = 0, .shadow_map = 0};

TEST(KitchenTrajectory, HasMinimumJerkFromRestToRest) {
  Trajectory trajectory(RobotVector::Zero());
  trajectory.move(5, 0.8, 1.0, 2.0);
  EXPECT_DOUBLE_EQ(trajectory.at(1.0).position[5], 0);
  EXPECT_NEAR(trajectory.at(2.0).position[5], 0.4, 1e-12);
  EXPECT_NEAR(trajectory.at(2.0).velocity[5], 1.875 * 0.8 / 2.0, 1e-12);
  EXPECT_NEAR(trajectory.at(2.0).acceleration[5], 0, 1e-12);
  EXPECT_DOUBLE_EQ(trajectory.at(3.0).position[5], 0.8);
  EXPECT_DOUBLE_EQ(trajectory.at(9.0).velocity[5], 0);
}

TEST(KitchenTrajectory, GoesElsewhereOnItsWayWithoutAJump) {
  Trajectory trajectory(RobotVector::Zero());
  trajectory.move(0, 1.0, 0.0, 2.0);
  const Motion before = trajectory.at(0.7);
  trajectory.stop(0.7);
  const Motion after = trajectory.at(0.7);
  EXPECT_NEAR(after.position[0], before.position[0], 1e-12);
  EXPECT_NEAR(after.velocity[0], before.velocity[0], 1e-12);
  EXPECT_NEAR(after.acceleration[0], before.acceleration[0], 1e-9);
  EXPECT_GT(trajectory.goal()[0], before.position[0]);
  EXPECT_LT(trajectory.goal()[0], 0.7);
  EXPECT_DOUBLE_EQ(trajectory.at(2.0).velocity[0], 0);
}

TEST(KitchenReach, FindsEverySlotWithBothHands) {
  Layout layout = make_layout(1);
  auto world = World::create(layout, kSmall);
  ASSERT_TRUE(world.ok()) << world.status().to_string();
  Kinematics kinematics(*world);
  for (const Surface surface : {Surface::kCounter, Surface::kTable})
    for (const Side side : {Side::kLeft, Side::kRight})
      for (const ThingClass& type : all_thing_classes()) {
        const Eigen::Vector3d foot = slot_point(surface, 1);
        const double heading = place_of(surface).heading_rad;
        Pose thing = Pose::Identity();
        thing.linear() =
            Eigen::AngleAxisd(heading + 0.3, Eigen::Vector3d::UnitZ()).toRotationMatrix();
        thing.translation() = foot + Eigen::Vector3d(0, 0, 0.5 * type.size_m.z());
        RobotVector robot = resting_pose();
        robot.head<3>() = standing_at(foot, surface, 0.19 * sign_of(side));
        const Grasp grasp = grasp_of(type, thing, side, heading);
        const auto answer = kinematics.solve(robot, side, thing * grasp.pose_thing_hand);
        EXPECT_LT(answer.error_m, 0.005) << type.name << " " << to_string(side);
        for (int i = 0; i < kRobotJoints; ++i) {
          EXPECT_GE(answer.pose[i], world->range(i).first) << joint_names().at(i);
          EXPECT_LE(answer.pose[i], world->range(i).second) << joint_names().at(i);
        }
      }
}

TEST(KitchenWorld, FollowsMotionsAndLetsThingsRest) {
  auto world = World::create(make_layout(2), kSmall);
  ASSERT_TRUE(world.ok()) << world.status().to_string();
  Trajectory trajectory(world->positions());
  trajectory.move(joint_index("right_elbow"), 0.5, 0, 1);
  trajectory.move(joint_index("platform_x"), 0.3, 0, 1);
  for (int i = 0; i < 750; ++i) world->step(trajectory.at(i * World::kStep_s));
  EXPECT_LT((world->positions() - trajectory.goal()).cwiseAbs().maxCoeff(), 0.002);
  for (size_t i = 0; i < world->layout().things.size(); ++i) {
    const Thing& thing = world->layout().things[i];
    EXPECT_TRUE(is_upright(world->thing_pose(i))) << thing.type->name;
    EXPECT_NEAR(world->thing_pose(i).translation().z(),
                place_of(thing.surface).top_m.z() + 0.5 * thing.type->size_m.z(), 0.002);
  }
}

TEST(KitchenLayout, DiffersBySeedAndHasSevenThingsAtLeast) {
  std::set<double> lamps;
  for (uint64_t seed = 1; seed <= 50; ++seed) {
    const Layout layout = make_layout(seed);
    EXPECT_GE(layout.things.size(), 7u);
    std::set<std::pair<Surface, int>> places;
    std::set<const ThingClass*> types;
    for (const Thing& thing : layout.things) {
      places.insert({thing.surface, thing.slot});
      types.insert(thing.type);
    }
    EXPECT_EQ(places.size(), layout.things.size());
    EXPECT_EQ(types.size(), layout.things.size());
    lamps.insert(layout.light.lamp);
  }
  EXPECT_EQ(lamps.size(), 50u);
}

TEST(KitchenScript, SometimesPlansAFailedGraspAndAStop) {
  int faults = 0;
  int stops = 0;
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    const Layout layout = make_layout(seed);
    Script script(layout);
    for (int i = 0; i < 3; ++i) {
      const auto task = script.next();
      ASSERT_TRUE(task);
      EXPECT_EQ(task->to, other(task->from));
      faults += task->fault ? 1 : 0;
      stops += task->is_stopped ? 1 : 0;
      script.done(*task);
    }
  }
  EXPECT_GT(faults, 15);
  EXPECT_LT(faults, 40);
  EXPECT_GT(stops, 8);
  EXPECT_LT(stops, 35);
}

}  // namespace
}  // namespace engram::datasets::kitchen
