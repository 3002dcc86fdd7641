// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/occupancy_grid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "datasets/ros/message_type.h"
#include "tests/ltm/expect_status.h"

namespace engram::navigation {
namespace {

using datasets::ros::MessageType;
using datasets::ros::Serialization;

constexpr const char* kDefinition = R"(std_msgs/Header header
nav_msgs/MapMetaData info
int8[] data
================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
================
MSG: nav_msgs/MapMetaData
builtin_interfaces/Time map_load_time
float32 resolution
uint32 width
uint32 height
geometry_msgs/Pose origin
================
MSG: geometry_msgs/Pose
geometry_msgs/Point position
geometry_msgs/Quaternion orientation
================
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
================
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
)";

CostMap map_of_all_costs() {
  CostMap map;
  map.frame = {16, 16, 0.25, {-3, 4, 0.5}};
  map.costs.create(16, 16, CV_8UC1);
  for (int i = 0; i < 256; ++i) map.costs.data[i] = static_cast<uint8_t>(i);
  return map;
}

TEST(OccupancyGrid, GoesThroughTheMessagesOfRosAndBack) {
  const auto type =
      MessageType::create("nav_msgs/msg/OccupancyGrid", kDefinition, Serialization::kCdr);
  ASSERT_OK(type);
  const CostMap map = map_of_all_costs();
  const auto bytes = type->encode(occupancy_grid_of_map(map, time_from_ns(1'500'000'000)));
  ASSERT_OK(bytes);
  const auto message = type->decode(*bytes);
  ASSERT_OK(message);
  EXPECT_EQ(datasets::ros::header_stamp(*message), time_from_ns(1'500'000'000));
  const auto back = map_of_occupancy_grid(*message);
  ASSERT_OK(back);
  EXPECT_EQ(back->frame.rows, 16);
  EXPECT_NEAR(back->frame.pose_world_map.heading_rad, 0.5, 1e-12);
  EXPECT_EQ(back->frame.pose_world_map.x_m, -3);
  for (int i = 0; i < 256; ++i) {
    const auto cost = static_cast<uint8_t>(i);
    EXPECT_EQ(back->costs.data[i], cost_of_occupancy(occupancy_of_cost(cost)));
    EXPECT_NEAR(back->costs.data[i], i, 5);
    if (cost == 0 || cost >= kInscribedCost) {
      EXPECT_EQ(back->costs.data[i], cost);
    }
  }
  // Once an occupancy it stays the same.
  EXPECT_EQ(occupancy_grid_of_map(*back, {}).get<idf::Dict>().find("data")->get<idf::NdArray>(),
            message->at("data")->get<idf::NdArray>());
}

TEST(OccupancyGrid, ReadsBytesThatOtherToolsCallUnsigned) {
  const idf::Data message = occupancy_grid_of_map(map_of_all_costs(), {});
  idf::Data other = message;
  std::vector<uint8_t> cells;
  for (const int8_t cell : message.at("data")->get<idf::NdArray>().values<int8_t>())
    cells.push_back(static_cast<uint8_t>(cell));
  const auto count = static_cast<int64_t>(cells.size());
  *other.at("data") = idf::NdArray::take<uint8_t>({count}, std::move(cells));
  const auto map = map_of_occupancy_grid(other);
  ASSERT_OK(map);
  EXPECT_EQ(cv::countNonZero(map->costs != map_of_occupancy_grid(message)->costs), 0);
}

TEST(OccupancyGrid, KeepsEachOccupancy) {
  EXPECT_EQ(occupancy_of_cost(cost_of_occupancy(-1)), -1);
  for (int occupancy = 0; occupancy <= 100; ++occupancy)
    EXPECT_EQ(occupancy_of_cost(cost_of_occupancy(occupancy)), occupancy);
  EXPECT_EQ(cost_of_occupancy(101), kUnknownCost);
  EXPECT_EQ(cost_of_occupancy(-128), kUnknownCost);
}

TEST(OccupancyGrid, RefusesMessagesThatContradictThemselves) {
  const idf::Data good = occupancy_grid_of_map(map_of_all_costs(), {});
  idf::Data bad = good;
  *bad.at("info/width") = int64_t{17};
  EXPECT_FAILS(map_of_occupancy_grid(bad), StatusCode::kInvalidArgument,
               "has 256 cells, its 16 rows of 17 need 272");
  bad = good;
  *bad.at("info/height") = int64_t{4'000'000'000};
  EXPECT_FAILS(map_of_occupancy_grid(bad), StatusCode::kInvalidArgument, "info/height");
  bad = good;
  *bad.at("info/resolution") = 0.0f;
  EXPECT_FAILS(map_of_occupancy_grid(bad), StatusCode::kInvalidArgument, "resolution");
  bad = good;
  *bad.at("info/origin/position/x") = std::nan("");
  EXPECT_FAILS(map_of_occupancy_grid(bad), StatusCode::kInvalidArgument, "position/x");
  bad = good;
  *bad.at("data") = "walls";
  EXPECT_FAILS(map_of_occupancy_grid(bad), StatusCode::kInvalidArgument, "data is string");
  EXPECT_FAILS(map_of_occupancy_grid(idf::Data()), StatusCode::kInvalidArgument, "info/width");
}

}  // namespace
}  // namespace engram::navigation
