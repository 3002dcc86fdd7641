// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/path_planner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "server/navigation/free_space.h"
#include "tests/ltm/expect_status.h"
#include "tests/server/navigation/map_example.h"

namespace engram::navigation {
namespace {

using testing::map_of_obstacles;

using ::testing::HasSubstr;

Obstacle box(const std::string& name, const PlanarPose& pose, double x, double y) {
  Obstacle obstacle;
  obstacle.name = name;
  obstacle.snapshot = testing::thing_id(name).at(testing::kBegin).instance(0);
  obstacle.pose_world_obstacle = pose;
  obstacle.size_m = {x, y};
  return obstacle;
}

void expect_free(const CostMap& map, const std::vector<PlanarPose>& path) {
  for (size_t i = 1; i < path.size(); ++i)
    for (int share = 0; share <= 500; ++share) {
      const Eigen::Vector2d point =
          path[i - 1].position() + (path[i].position() - path[i - 1].position()) * share / 500.0;
      ASSERT_LT(map.cost_at(point), kInscribedCost) << point.transpose();
    }
}

/// A wall with a door of 1.2 m.
std::vector<Obstacle> walled() {
  return {box("left wall", {-2.8, 0, 0}, 4.4, 0.2), box("right wall", {2.8, 0, 0}, 4.4, 0.2)};
}

TEST(PathPlanner, GoesThroughADoorAndTouchesNothing) {
  const PathPlanner planner = PathPlanner::create({}).value();
  const CostMap map = map_of_obstacles(walled());
  const FoundPath found = planner.plan(map, {-3, -3, 0}, {3, 3, 1});
  ASSERT_TRUE(found.is_found()) << found.reason;
  expect_free(map, found.path);
  EXPECT_EQ(found.path.front(), (PlanarPose{-3, -3, 0}));
  EXPECT_EQ(found.path.back(), (PlanarPose{3, 3, 1}));
  EXPECT_LT(found.length_m, 10.5);
  // Straight on where nothing is in the way.
  const FoundPath straight = planner.plan(map, {-3, -3, 0}, {3, -3, 1});
  EXPECT_EQ(straight.path.size(), 2U);
  EXPECT_NEAR(straight.length_m, 6, 1e-9);
}

TEST(PathPlanner, FindsTheSameWayForTheSameSeed) {
  const PathPlanner planner = PathPlanner::create({}).value();
  std::vector<Obstacle> obstacles = walled();
  obstacles.push_back(box("chair_1", {0, 2, 0.4}, 0.5, 0.5));
  obstacles.push_back(box("chair_2", {0.3, -1.4, 0.4}, 0.5, 0.5));
  const CostMap map = map_of_obstacles(obstacles);
  const FoundPath once = planner.plan(map, {-3, -3, 0}, {3, 3, 1});
  ASSERT_TRUE(once.is_found()) << once.reason;
  for (int i = 0; i < 5; ++i) EXPECT_EQ(planner.plan(map, {-3, -3, 0}, {3, 3, 1}).path, once.path);
}

TEST(PathPlanner, FindsAWayOrProvesThatThereIsNone) {
  const PathPlanner planner = PathPlanner::create({}).value();
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-4.5, 4.5);
  int found_ways = 0;
  for (int i = 0; i < 40; ++i) {
    std::vector<Obstacle> obstacles;
    for (int k = 0; k < 25; ++k)
      obstacles.push_back(
          box("box_" + std::to_string(k), {place(random), place(random), place(random)}, 0.8, 0.3));
    const CostMap map = map_of_obstacles(obstacles);
    const PlanarPose start{place(random), place(random), 0};
    const PlanarPose goal{place(random), place(random), 0};
    const FoundPath found = planner.plan(map, start, goal);
    const FreeSpace space(map);
    if (space.is_passable(start.position())) {
      EXPECT_EQ(found.is_found(),
                space.is_passable(goal.position()) &&
                    space.part_of(start.position()) == space.part_of(goal.position()))
          << i << ": " << found.reason;
      if (found.is_found()) expect_free(map, found.path);
    }
    EXPECT_NE(found.is_found(), !found.reason.empty());
    found_ways += found.is_found() ? 1 : 0;
  }
  EXPECT_GT(found_ways, 5);
}

TEST(PathPlanner, SaysWhatIsAtAGoalThatIsNotFree) {
  const PathPlanner planner = PathPlanner::create({}).value();
  const CostMap map =
      map_of_obstacles({box("chair_1", {2, 0, 0}, 0.5, 0.5), box("sofa", {-3, 3, 0}, 1, 2)});
  for (const double x : {2.0, 1.5}) {
    const FoundPath found = planner.plan(map, {0, 0, 0}, {x, 0, 0});
    EXPECT_FALSE(found.is_found());
    EXPECT_FALSE(found.is_trapped);
    EXPECT_THAT(found.reason, HasSubstr("not free: the robot would be too near to chair_1"));
    ASSERT_EQ(found.blocked_by.size(), 1U);
    EXPECT_EQ(found.blocked_by[0].name, "chair_1");
  }
  EXPECT_THAT(planner.plan(map, {0, 0, 0}, {9, 0, 0}).reason, HasSubstr("border of the map"));
}

TEST(PathPlanner, SaysWhatItsStartCollidesWith) {
  const PathPlanner planner = PathPlanner::create({}).value();
  const CostMap map = map_of_obstacles({box("table", {0, 0, 0}, 2, 2)});
  const FoundPath found = planner.plan(map, {0.5, 0.5, 0}, {3, 0, 0});
  EXPECT_THAT(found.reason, HasSubstr("is in collision with table"));
}

TEST(PathPlanner, LeavesAStartThatIsTooNearToSomething) {
  const PathPlanner planner = PathPlanner::create({}).value();
  const CostMap map = map_of_obstacles({box("table", {0, 0, 0}, 2, 2)});
  const FoundPath found = planner.plan(map, {1.2, 0, 0}, {3, 0, 0});
  ASSERT_TRUE(found.is_found()) << found.reason;
  EXPECT_EQ(found.path.front(), (PlanarPose{1.2, 0, 0}));
}

TEST(PathPlanner, KnowsThatItIsTrappedAndByWhom) {
  const PathPlanner planner = PathPlanner::create({}).value();
  std::vector<Obstacle> ring;
  for (int i = 0; i < 6; ++i)
    ring.push_back(box(fmt::format("person_{}", i), {std::cos(i * 1.0472), std::sin(i * 1.0472), 0},
                       0.5, 0.5));
  ring.push_back(box("sofa", {4, 4, 0}, 0.5, 0.5));
  const FoundPath found = planner.plan(map_of_obstacles(ring), {0, 0, 0}, {3, 0, 0});
  EXPECT_TRUE(found.is_trapped);
  EXPECT_EQ(found.blocked_by.size(), 6U);
  EXPECT_THAT(found.reason, HasSubstr("is surrounded by person_"));
}

TEST(PathPlanner, SaysWhatClosesOffTheGoal) {
  const PathPlanner planner = PathPlanner::create({}).value();
  std::vector<Obstacle> obstacles = walled();
  obstacles.push_back(box("chair_1", {0, 0, 0}, 0.5, 0.5));
  const FoundPath found = planner.plan(map_of_obstacles(obstacles), {0, -3, 0}, {0, 3, 0});
  EXPECT_FALSE(found.is_trapped);
  EXPECT_THAT(found.reason, HasSubstr("closes off"));
  EXPECT_THAT(found.reason, HasSubstr("chair_1"));
  EXPECT_EQ(found.blocked_by.size(), 3U);
}

TEST(PathPlanner, RefusesOptionsThatDoNotValidate) {
  EXPECT_FAILS(PathPlanner::create({.tries = 0}), StatusCode::kInvalidArgument, "0 tries");
  EXPECT_FAILS(PathPlanner::create({.seed = 0}), StatusCode::kInvalidArgument, "seed");
  EXPECT_FAILS(PathPlanner::create({.time_limit = {}}), StatusCode::kInvalidArgument, "time limit");
}

TEST(FreeSpace, VisitsAllCellsThatALineCrosses) {
  const GridFrame frame{100, 100, 0.1, {-5, -5, 0.3}};
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-3, 3);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector2d a(place(random), place(random));
    const Eigen::Vector2d b(place(random), place(random));
    std::set<std::pair<int, int>> visited;
    EXPECT_TRUE(visit_cells(frame, a, b, [&](const cv::Point& cell) {
      visited.insert({cell.x, cell.y});
      return true;
    }));
    size_t missed = 0;
    for (int share = 0; share <= 2000; ++share) {
      const cv::Point cell = frame.cell_of(a + (b - a) * share / 2000.0);
      missed += visited.contains({cell.x, cell.y}) ? 0 : 1;
    }
    // Points on a border between two cells may be told to be in either of them.
    EXPECT_LE(missed, 1U);
  }
}

}  // namespace
}  // namespace engram::navigation
