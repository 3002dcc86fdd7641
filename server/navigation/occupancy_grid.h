// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/navigation/cost_map.h"

namespace engram::navigation {

/// The cost of an occupancy, such that occupancy_of_cost gives the same occupancy again. -1 and
/// what is no occupancy are unknown.
[[nodiscard]] uint8_t cost_of_occupancy(int occupancy);

/// The occupancy of a cost, as Nav2 publishes its maps: 255 is -1, 254 is 100, 253 is 99, and 1 to
/// 252 are spread over 1 to 98.
[[nodiscard]] int8_t occupancy_of_cost(uint8_t cost);

/// A nav_msgs/OccupancyGrid as rooms of ROS hand it over, as a map without obstacles. The map is in
/// the frame of the message.
/// Errors: kInvalidArgument naming the member, what was found and what was needed.
Result<CostMap> map_of_occupancy_grid(const idf::Data& message);

/// The same back, as a dict of the fields of nav_msgs/OccupancyGrid of ROS 2 that datasets/ros
/// encodes. `frame_id` names the frame of the world.
[[nodiscard]] idf::Data occupancy_grid_of_map(const CostMap& map, Time stamp,
                                              const std::string& frame_id = "map");

}  // namespace engram::navigation
