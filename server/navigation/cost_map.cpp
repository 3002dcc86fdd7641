// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/cost_map.h"

#include <algorithm>
#include <cmath>

#include "ltm/typed/image.h"
#include "server/navigation/navigation_types.h"

namespace engram::navigation {

namespace {

::navigation::MapObstacle value_of(const Obstacle& obstacle) {
  ::navigation::MapObstacle value;
  value.snapshot = obstacle.snapshot;
  value.name = obstacle.name;
  value.shape = obstacle.shape == Obstacle::Shape::kBox ? ::navigation::ObstacleShape::BOX
                                                        : ::navigation::ObstacleShape::CYLINDER;
  value.pose_world_obstacle = obstacle.pose_world_obstacle.to_array();
  value.size = idf::NdArray::take<double>({2}, {obstacle.size_m.x(), obstacle.size_m.y()});
  value.max_speed = obstacle.max_speed_m_s;
  return value;
}

Result<Obstacle> obstacle_of(const ::navigation::MapObstacle& value) {
  Obstacle obstacle;
  obstacle.snapshot = value.snapshot;
  obstacle.name = value.name;
  obstacle.shape = value.shape == ::navigation::ObstacleShape::BOX ? Obstacle::Shape::kBox
                                                                   : Obstacle::Shape::kCylinder;
  const auto pose = PlanarPose::from_array(value.pose_world_obstacle);
  if (!pose)
    return invalid_argument("cost map: pose_world_obstacle of '{}' needs 3 finite numbers",
                            value.name);
  obstacle.pose_world_obstacle = *pose;
  if (value.size.type() != idf::ElementType::kFloat64 || value.size.shape() != idf::Shape{2})
    return invalid_argument("cost map: size of '{}' is {} {}, needs float64 [2]", value.name,
                            idf::to_string(value.size.type()), idf::to_string(value.size.shape()));
  const auto size = value.size.values<double>();
  if (!(size[0] >= 0 && size[0] < 1e6 && size[1] >= 0 && size[1] < 1e6))
    return invalid_argument("cost map: size of '{}' is {} x {} m, needs 0 to 1,000,000", value.name,
                            size[0], size[1]);
  obstacle.size_m = {size[0], size[1]};
  if (!(value.max_speed >= 0 && value.max_speed < 1e3))
    return invalid_argument("cost map: max_speed of '{}' is {} m/s, needs 0 to 1,000", value.name,
                            value.max_speed);
  obstacle.max_speed_m_s = value.max_speed;
  return obstacle;
}

}  // namespace

uint8_t CostRules::cost(double distance_m) const {
  if (distance_m <= 0) return kLethalCost;
  if (distance_m <= inscribed_m()) return kInscribedCost;
  if (distance_m > inflation_radius_m) return kFreeCost;
  const double share = std::exp(-falloff_per_m * (distance_m - inscribed_m()));
  // At least 1, so that who reads the map sees how far the inflation goes.
  return static_cast<uint8_t>(std::clamp(std::floor((kInscribedCost - 1) * share), 1.0, 252.0));
}

Status CostRules::validate() const {
  if (!(robot_radius_m > 0 && robot_radius_m <= 10))
    return invalid_argument("costs: robot_radius is {} m, needs more than 0 and at most 10",
                            robot_radius_m);
  if (!(clearance_m >= 0 && clearance_m <= 10))
    return invalid_argument("costs: clearance is {} m, needs 0 to 10", clearance_m);
  if (!(inflation_radius_m >= inscribed_m() && inflation_radius_m <= 50))
    return invalid_argument(
        "costs: inflation_radius is {} m, needs at least robot_radius + clearance = {} m and at "
        "most 50",
        inflation_radius_m, inscribed_m());
  if (!(falloff_per_m >= 0 && falloff_per_m <= 1000))
    return invalid_argument("costs: falloff is {} per m, needs 0 to 1000", falloff_per_m);
  return {};
}

uint8_t CostMap::cost_at(const Eigen::Vector2d& point) const {
  const cv::Point cell = frame.cell_of(point);
  return frame.has(cell) ? costs.at<uint8_t>(cell) : kUnknownCost;
}

idf::Data CostMap::to_data() const {
  ::navigation::CostMap value;
  value.version = version;
  value.resolution = frame.resolution_m;
  value.pose_world_map = frame.pose_world_map.to_array();
  std::vector<uint8_t> cells(costs.total());
  cv::Mat copied(costs.size(), CV_8UC1, cells.data());
  costs.copyTo(copied);
  value.costs = idf::NdArray::take<uint8_t>({costs.rows, costs.cols}, std::move(cells));
  value.inscribed_radius = inscribed_m;
  value.inflation_radius = inflation_m;
  for (const Obstacle& obstacle : obstacles) value.made_of.push_back(value_of(obstacle));
  for (const LeftOutThing& thing : left_out) {
    ::navigation::LeftOut& left = value.left_out.emplace_back();
    left.snapshot = thing.snapshot;
    left.reason = thing.reason;
  }
  return value.to_idf();
}

Result<CostMap> CostMap::from_data(const idf::Data& data, ltm::MemoryId id) {
  ENGRAM_ASSIGN_OR_RETURN(const auto value, ::navigation::CostMap::from_idf(data));
  CostMap map;
  map.id = std::move(id);
  if (value.version < 0)
    return invalid_argument("cost map: version is {}, needs at least 0", value.version);
  map.version = value.version;
  if (value.costs.rank() != 2 || value.costs.type() != idf::ElementType::kUInt8)
    return invalid_argument("cost map: costs are {} {}, need uint8 [rows, columns]",
                            idf::to_string(value.costs.type()),
                            idf::to_string(value.costs.shape()));
  const int64_t rows = value.costs.shape()[0];
  const int64_t columns = value.costs.shape()[1];
  if (rows > GridFrame::kMaxCells || columns > GridFrame::kMaxCells)
    return invalid_argument("cost map: has {} x {} cells, needs at most {}", rows, columns,
                            GridFrame::kMaxCells);
  const auto pose = PlanarPose::from_array(value.pose_world_map);
  if (!pose) return invalid_argument("cost map: pose_world_map needs 3 finite numbers");
  map.frame = {static_cast<int>(rows), static_cast<int>(columns), value.resolution, *pose};
  ENGRAM_RETURN_IF_ERROR(map.frame.validate());
  // The Mat lies over the bytes of the array and keeps them alive; nobody writes to it.
  const auto cells =
      idf::NdArray::create(idf::ElementType::kUInt8, {rows, columns, 1}, value.costs.buffer());
  ENGRAM_RETURN_IF_ERROR(cells.status());
  const auto costs = typed::mat_of(*cells);
  if (!costs) return invalid_argument("cost map: {} x {} costs are no picture", rows, columns);
  map.costs = *costs;
  // Infinity and NaN are refused as well.
  const auto is_length = [](double metres) { return metres >= 0 && std::isfinite(metres); };
  if (!is_length(value.inscribed_radius) || !is_length(value.inflation_radius))
    return invalid_argument(
        "cost map: inscribed_radius is {} m and inflation_radius {} m, need to be finite and at "
        "least 0",
        value.inscribed_radius, value.inflation_radius);
  map.inscribed_m = value.inscribed_radius;
  map.inflation_m = value.inflation_radius;
  for (const ::navigation::MapObstacle& obstacle : value.made_of) {
    ENGRAM_ASSIGN_OR_RETURN(map.obstacles.emplace_back(), obstacle_of(obstacle));
  }
  for (const ::navigation::LeftOut& left : value.left_out)
    map.left_out.push_back({left.snapshot, left.reason});
  return map;
}

std::string names_of(const std::vector<Obstacle>& obstacles) {
  constexpr size_t kNamed = 5;
  std::string names;
  for (size_t i = 0; i < std::min(obstacles.size(), kNamed); ++i) {
    const bool is_last = i + 1 == obstacles.size();
    if (i > 0) names += is_last ? " and " : ", ";
    names += obstacles[i].name;
  }
  if (obstacles.size() > kNamed) names += fmt::format(" and {} more", obstacles.size() - kNamed);
  return names;
}

}  // namespace engram::navigation
