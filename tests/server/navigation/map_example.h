// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "server/navigation/obstacle_map.h"
#include "tests/server/navigation/floor_example.h"

namespace engram::navigation::testing {

/// The map of an empty floor of 10 x 10 m on which these stand.
inline CostMap map_of_obstacles(const std::vector<Obstacle>& obstacles) {
  ObstacleMap made = ObstacleMap::create({}, {}).value();
  for (size_t i = 0; i < obstacles.size(); ++i) made.set(thing_id(std::to_string(i)), obstacles[i]);
  CostMap map;
  map.frame = made.frame();
  map.costs = made.update().clone();
  map.inscribed_m = made.rules().inscribed_m();
  map.inflation_m = made.rules().inflation_radius_m;
  map.obstacles = obstacles;
  return map;
}

}  // namespace engram::navigation::testing
