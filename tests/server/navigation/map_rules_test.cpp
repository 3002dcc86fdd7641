// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/map_rules.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/ltm/expect_status.h"

namespace engram::navigation {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;

Result<MapRules> rules_of(const std::string& yaml) {
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue value, ConfigValue::parse(yaml, "map.yaml"));
  return MapRules::read(value);
}

TEST(MapRules, KeepTheirDefaultsWhereNothingIsSaid) {
  const auto rules = rules_of("");
  ASSERT_OK(rules);
  EXPECT_EQ(rules->frame, GridFrame{});
  EXPECT_THAT(rules->sources, SizeIs(2));
  EXPECT_EQ(rules->entity().to_string(), "Navigation/CostMap/navigation/floor");
}

TEST(MapRules, ReadEveryKey) {
  const auto rules = rules_of(R"(provider: maps
map: hall
grid: {x: -1, y: -2, heading: 0.5, width: 4, height: 2, resolution: 0.1}
costs: {robot_radius: 0.25, clearance: 0.15, inflation_radius: 1.5, falloff: 2}
sources:
  - {names: World/Things/.*/.*, pose: pose, class: kind, size: extent, shape: form, held: holder}
  - {is_surface: true, names: World/Tables/.*/.*, depth: x, width: y}
classes: [World/Kinds/.*/.*]
ignore: [rug.*]
speeds: [{name: dog.*, max_speed: 2}]
min_height: 0.05
max_height: 1.5
reaction: 0.3
)");
  ASSERT_OK(rules);
  EXPECT_EQ(rules->entity().to_string(), "Navigation/CostMap/maps/hall");
  EXPECT_EQ(rules->frame, (GridFrame{20, 40, 0.1, {-1, -2, 0.5}}));
  EXPECT_EQ(rules->costs.inscribed_m(), 0.4);
  EXPECT_EQ(rules->sources[0].size_member, "extent");
  EXPECT_TRUE(rules->sources[1].is_surface);
  EXPECT_EQ(rules->sources[1].pose_member, "pose_world_surface");
  EXPECT_EQ(rules->sources[1].width_member, "y");
  EXPECT_THAT(rules->ignored, ElementsAre("rug.*"));
  EXPECT_EQ(rules->speeds[0].max_speed_m_s, 2);
  EXPECT_EQ(rules->reaction_s, 0.3);
}

TEST(MapRules, RefuseWhatDoesNotFitWithItsLine) {
  EXPECT_FAILS(rules_of("grid: {width: 4, hight: 2}"), StatusCode::kInvalidArgument, "hight");
  EXPECT_FAILS(rules_of("map: a\ngrid: {width: 1e9}"), StatusCode::kInvalidArgument, "map.yaml:2");
  EXPECT_FAILS(rules_of("grid: {resolution: 0}"), StatusCode::kInvalidArgument, "map.yaml:1");
  EXPECT_FAILS(rules_of("costs: {robot_radius: -1}"), StatusCode::kInvalidArgument, "robot_radius");
  EXPECT_FAILS(rules_of("sources: []"), StatusCode::kInvalidArgument, "needs one");
  EXPECT_FAILS(rules_of("sources: [{names: 'Objects/(/x/y'}]"), StatusCode::kInvalidArgument, "(");
  EXPECT_FAILS(rules_of("speeds: [{max_speed: 1}]"), StatusCode::kInvalidArgument, "name");
  EXPECT_FAILS(rules_of("min_height: 3"), StatusCode::kInvalidArgument, "min_height");
}

}  // namespace
}  // namespace engram::navigation
