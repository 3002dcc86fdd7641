// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/cost_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <opencv2/core.hpp>

#include "ltm/memory/links.h"
#include "server/navigation/navigation_types.h"
#include "tests/ltm/expect_status.h"
#include "tests/server/navigation/floor_example.h"

namespace engram::navigation {
namespace {

using testing::thing_id;

CostMap example() {
  CostMap map;
  map.frame = {3, 4, 0.5, {1, 2, 0.25}};
  map.costs = (cv::Mat_<uint8_t>(3, 4) << 0, 1, 2, 3, 252, 253, 254, 255, 7, 8, 9, 10);
  map.inscribed_m = 0.4;
  map.inflation_m = 0.9;
  map.version = 12;
  Obstacle& chair = map.obstacles.emplace_back();
  chair.snapshot = thing_id("chair_1").at(testing::kBegin).instance(0);
  chair.name = "chair_1";
  chair.shape = Obstacle::Shape::kCylinder;
  chair.pose_world_obstacle = {1.5, 2.5, -1};
  chair.size_m = {0.4, 0.4};
  chair.max_speed_m_s = 0.5;
  map.left_out.push_back({thing_id("ghost").at(testing::kBegin).instance(0), "it has no class"});
  return map;
}

TEST(CostMap, ComesBackFromItsValueAsItWas) {
  const CostMap map = example();
  const auto back = CostMap::from_data(map.to_data());
  ASSERT_OK(back);
  EXPECT_EQ(back->frame, map.frame);
  EXPECT_EQ(cv::countNonZero(back->costs != map.costs), 0);
  EXPECT_EQ(back->version, 12);
  EXPECT_EQ(back->left_out, map.left_out);
  ASSERT_EQ(back->obstacles.size(), 1U);
  EXPECT_EQ(back->obstacles[0].snapshot, map.obstacles[0].snapshot);
  EXPECT_EQ(back->obstacles[0].shape, Obstacle::Shape::kCylinder);
  EXPECT_TRUE(back->obstacles[0].is_at(map.obstacles[0]));
  EXPECT_EQ(back->obstacles[0].max_speed_m_s, 0.5);
}

TEST(CostMap, LinksToTheSnapshotsThatItIsMadeOf) {
  const auto links = ltm::find_links(example().to_data(), ::navigation::CostMap::idf_type());
  ASSERT_EQ(links.size(), 2U);
  EXPECT_EQ(links[0].path, "made_of/0/snapshot");
  EXPECT_EQ(links[0].id, thing_id("chair_1").at(testing::kBegin).instance(0));
}

TEST(CostMap, HasRowZeroAtTheLowestY) {
  CostMap map = example();
  map.frame.pose_world_map = {1, 2, 0};
  EXPECT_EQ(map.cost_at({1.1, 2.1}), 0);
  EXPECT_EQ(map.cost_at({2.9, 2.1}), 3);
  EXPECT_EQ(map.cost_at({1.1, 2.6}), 252);
  EXPECT_EQ(map.cost_at({0.9, 2.1}), kUnknownCost);
  // Turned by a quarter, columns go along y of the world.
  map.frame.pose_world_map.heading_rad = std::numbers::pi / 2;
  EXPECT_EQ(map.cost_at({0.9, 3.6}), 3);
}

TEST(CostMap, RefusesHostileValues) {
  idf::Data value = example().to_data();
  *value.at("resolution") = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FAILS(CostMap::from_data(value), StatusCode::kInvalidArgument, "resolution");
  value = example().to_data();
  *value.at("pose_world_map") =
      idf::NdArray::take<double>({3}, {0, std::numeric_limits<double>::infinity(), 0});
  EXPECT_FAILS(CostMap::from_data(value), StatusCode::kInvalidArgument, "pose_world_map");
  value = example().to_data();
  *value.at("costs") = idf::NdArray::take<uint8_t>({0, 4}, {});
  EXPECT_FAILS(CostMap::from_data(value), StatusCode::kInvalidArgument, "0 rows");
  value = example().to_data();
  *value.at("made_of/0/size") = idf::NdArray::take<double>({2}, {-1, 1});
  EXPECT_FAILS(CostMap::from_data(value), StatusCode::kInvalidArgument, "size of 'chair_1'");
  value = example().to_data();
  *value.at("version") = int64_t{-1};
  EXPECT_FAILS(CostMap::from_data(value), StatusCode::kInvalidArgument, "version is -1");
  for (const char* radius : {"inscribed_radius", "inflation_radius"})
    for (const double number : {-0.1, std::numeric_limits<double>::quiet_NaN(),
                                std::numeric_limits<double>::infinity()}) {
      value = example().to_data();
      *value.at(radius) = number;
      EXPECT_FAILS(CostMap::from_data(value), StatusCode::kInvalidArgument, radius);
    }
  EXPECT_FAILS(CostMap::from_data(idf::Dict{{"costs", 3}}), StatusCode::kInvalidArgument, "");
}

TEST(CostMap, NamesAFewOfManyObstacles) {
  std::vector<Obstacle> obstacles;
  EXPECT_EQ(names_of(obstacles), "");
  for (const char* name : {"a", "b", "c", "d", "e", "f", "g"}) {
    obstacles.emplace_back().name = name;
    if (obstacles.size() == 2) {
      EXPECT_EQ(names_of(obstacles), "a and b");
    }
  }
  EXPECT_EQ(names_of(obstacles), "a, b, c, d, e and 2 more");
}

}  // namespace
}  // namespace engram::navigation
