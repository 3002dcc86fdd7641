// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/obstacle_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <opencv2/core.hpp>
#include <random>

#include "tests/ltm/expect_status.h"
#include "tests/server/navigation/floor_example.h"

namespace engram::navigation {
namespace {

using testing::thing_id;

Obstacle post(double x, double y, double diameter) {
  Obstacle obstacle;
  obstacle.shape = Obstacle::Shape::kCylinder;
  obstacle.pose_world_obstacle = {x, y, 0};
  obstacle.size_m = {diameter, diameter};
  return obstacle;
}

int differing_cells(const cv::Mat& a, const cv::Mat& b) {
  return cv::countNonZero(a != b);
}

Obstacle random_obstacle(std::mt19937& random) {
  std::uniform_real_distribution<double> place(-6, 6);
  std::uniform_real_distribution<double> size(0.05, 1.5);
  Obstacle obstacle = post(place(random), place(random), size(random));
  if (random() % 2 == 0) {
    obstacle.shape = Obstacle::Shape::kBox;
    obstacle.pose_world_obstacle.heading_rad = place(random);
    obstacle.size_m.y() = size(random);
  }
  return obstacle;
}

/// A map that create() makes and that is told of all obstacles at once.
cv::Mat made_fresh(const GridFrame& frame, const CostRules& rules,
                   const std::optional<cv::Mat>& base,
                   const std::map<ltm::MemoryId, std::pair<Obstacle, double>>& obstacles) {
  auto map = ObstacleMap::create(frame, rules, base);
  ENGRAM_CHECK(map.ok(), "{}", map.status().message());
  for (const auto& [entity, obstacle] : obstacles)
    map->set(entity, obstacle.first, obstacle.second);
  return map->update().clone();
}

/// Obstacles come, move and go at random, and after each step the map is compared with one that is
/// made from nothing.
void expect_equal_maps(const GridFrame& frame, const CostRules& rules,
                       const std::optional<cv::Mat>& base, int steps, uint32_t seed) {
  auto map = ObstacleMap::create(frame, rules, base);
  ASSERT_OK(map);
  std::mt19937 random(seed);
  std::map<ltm::MemoryId, std::pair<Obstacle, double>> there;
  int differing = 0;
  for (int step = 0; step < steps; ++step) {
    // Now and then several change before the map is brought up to date.
    for (uint32_t changes = 1 + random() % 3; changes > 0; --changes) {
      const ltm::MemoryId entity = thing_id("thing_" + std::to_string(random() % 12));
      if (random() % 4 == 0) {
        map->remove(entity);
        there.erase(entity);
      } else {
        const Obstacle obstacle = random_obstacle(random);
        const double grown_m = random() % 3 == 0 ? 0.2 : 0;
        map->set(entity, obstacle, grown_m);
        there[entity] = {obstacle, grown_m};
      }
    }
    differing += differing_cells(map->update(), made_fresh(frame, rules, base, there));
  }
  EXPECT_EQ(differing, 0);
}

TEST(ObstacleMap, IsAfterEachOf3000MovesWhatAMapMadeAnewIs) {
  expect_equal_maps({}, {}, {}, 3000, 1);
}

TEST(ObstacleMap, IsWhatAMapMadeAnewIsOnATurnedCoarseGridWithWalls) {
  GridFrame frame;
  frame.rows = 61;
  frame.columns = 83;
  frame.resolution_m = 0.13;
  frame.pose_world_map = {-4, -5, 0.4};
  cv::Mat base = cv::Mat::zeros(frame.size(), CV_8UC1);
  base.row(0).setTo(kLethalCost);
  base.colRange(70, 83).setTo(kUnknownCost);
  base.rowRange(30, 32).setTo(100);
  expect_equal_maps(frame, {.inflation_radius_m = 1.3}, base, 2000, 2);
}

TEST(ObstacleMap, HasTheCostsOfNav2AroundAnObstacle) {
  auto map = ObstacleMap::create({}, {});
  ASSERT_OK(map);
  map->set(thing_id("post"), post(0.025, 0.025, 0.02));
  CostMap shown{.frame = map->frame(), .costs = map->update()};
  EXPECT_EQ(shown.cost_at({0.025, 0.025}), kLethalCost);
  EXPECT_EQ(shown.cost_at({0.075, 0.025}), kInscribedCost);
  EXPECT_EQ(shown.cost_at({0.425, 0.025}), kInscribedCost);
  EXPECT_EQ(shown.cost_at({0.475, 0.025}), map->rules().cost(0.45));
  EXPECT_LT(shown.cost_at({0.475, 0.025}), kInscribedCost);
  EXPECT_GT(shown.cost_at({0.525, 0.025}), shown.cost_at({0.725, 0.025}));
  EXPECT_EQ(shown.cost_at({0.975, 0.025}), kFreeCost);
  EXPECT_EQ(shown.cost_at({100, 0}), kUnknownCost);
  map->remove(thing_id("post"));
  EXPECT_EQ(cv::countNonZero(map->update()), 0);
}

// The promise that drives stand on: a robot with its middle in a free cell touches nothing.
TEST(ObstacleMap, LeavesNoFreePointNearerThanTheRobotsRadius) {
  std::mt19937 random(3);
  auto map = ObstacleMap::create({}, {});
  ASSERT_OK(map);
  std::vector<Obstacle> obstacles;
  for (int i = 0; i < 15; ++i) {
    obstacles.push_back(random_obstacle(random));
    map->set(thing_id(std::to_string(i)), obstacles.back());
  }
  const CostMap shown{.frame = map->frame(), .costs = map->update()};
  std::uniform_real_distribution<double> place(-5, 5);
  int free = 0;
  for (int i = 0; i < 100'000; ++i) {
    const Eigen::Vector2d point(place(random), place(random));
    if (!shown.is_free(point)) continue;
    ++free;
    for (const Obstacle& obstacle : obstacles)
      ASSERT_GT(obstacle.distance_m(point), map->rules().robot_radius_m + 0.029);
  }
  EXPECT_GT(free, 10'000);
}

TEST(ObstacleMap, KeepsWhatTheBaseDoesNotKnowUnlessTheRobotWouldTouchSomething) {
  GridFrame frame;
  auto map = ObstacleMap::create(frame, {}, cv::Mat(frame.size(), CV_8UC1, cv::Scalar(255)));
  ASSERT_OK(map);
  map->set(thing_id("post"), post(0, 0, 0.5));
  const CostMap shown{.frame = frame, .costs = map->update()};
  EXPECT_EQ(shown.cost_at({0, 0}), kLethalCost);
  EXPECT_EQ(shown.cost_at({0.5, 0}), kInscribedCost);
  EXPECT_EQ(shown.cost_at({0.8, 0}), kUnknownCost);
}

TEST(ObstacleMap, RefusesWhatContradictsItself) {
  EXPECT_FAILS(ObstacleMap::create({.rows = 0}, {}), StatusCode::kInvalidArgument, "0 rows");
  EXPECT_FAILS(ObstacleMap::create({.rows = 100'000, .columns = 100'000}, {}),
               StatusCode::kInvalidArgument, "at most");
  EXPECT_FAILS(ObstacleMap::create({}, {.inflation_radius_m = 0.2}), StatusCode::kInvalidArgument,
               "inflation_radius");
  EXPECT_FAILS(ObstacleMap::create({}, {.robot_radius_m = std::nan("")}),
               StatusCode::kInvalidArgument, "robot_radius");
  EXPECT_FAILS(ObstacleMap::create({}, {}, cv::Mat::zeros(3, 3, CV_8UC1)),
               StatusCode::kInvalidArgument, "its base has 3 x 3 cells");
}

TEST(ObstacleMap, RefusesRulesThatNeedAnyAmountOfMemoryTogether) {
  // Each is right alone: 50 m at 1 mm are 50,000 cells on each side.
  EXPECT_FAILS(ObstacleMap::create({.resolution_m = 0.001}, {.inflation_radius_m = 50}),
               StatusCode::kInvalidArgument, "is 50000 cells of 0.001 m, needs at most 4000");
  EXPECT_FAILS(ObstacleMap::create({.rows = 1000, .columns = 1000, .resolution_m = 0.001},
                                   {.inflation_radius_m = 3.9}),
               StatusCode::kInvalidArgument, "a border of 3900 cells");
  EXPECT_OK(ObstacleMap::create({.resolution_m = 0.01}, {.inflation_radius_m = 5}));
}

TEST(ObstacleMap, TakesObstaclesThatAreFarAwayOrHuge) {
  auto map = ObstacleMap::create({}, {});
  ASSERT_OK(map);
  map->set(thing_id("away"), post(1e12, -1e300, 1));
  EXPECT_EQ(cv::countNonZero(map->update()), 0);
  map->set(thing_id("huge"), post(0, 0, 1e5));
  EXPECT_EQ(cv::countNonZero(map->update() == kLethalCost), 200 * 200);
}

}  // namespace
}  // namespace engram::navigation
