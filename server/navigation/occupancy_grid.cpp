// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/occupancy_grid.h"

#include <cmath>

namespace engram::navigation {

namespace {

constexpr int kFullyOccupied = 100;
constexpr int kInscribed = 99;

/// Writes the costs of an array of int8, as ROS has it, or of uint8, as other tools write it.
Status read_cells(const idf::Data* data, CostMap& map) {
  const auto* array = data == nullptr ? nullptr : data->get_if<idf::NdArray>();
  if (array == nullptr || array->rank() != 1)
    return invalid_argument("occupancy grid: data is {}, needs an array of int8",
                            data == nullptr ? "missing" : data->kind_name());
  const bool is_signed = array->type() == idf::ElementType::kInt8;
  if (!is_signed && array->type() != idf::ElementType::kUInt8)
    return invalid_argument("occupancy grid: data has {}, needs int8",
                            idf::to_string(array->type()));
  const int64_t needed = int64_t{map.frame.rows} * map.frame.columns;
  if (array->count() != needed)
    return invalid_argument("occupancy grid: has {} cells, its {} rows of {} need {}",
                            array->count(), map.frame.rows, map.frame.columns, needed);
  map.costs.create(map.frame.size(), CV_8UC1);
  uint8_t* cost = map.costs.data;
  if (is_signed)
    for (const int8_t cell : array->values<int8_t>()) *cost++ = cost_of_occupancy(cell);
  else
    for (const uint8_t cell : array->values<uint8_t>())
      *cost++ = cost_of_occupancy(static_cast<int8_t>(cell));
  return {};
}

Result<double> number_at(const idf::Data& message, std::string_view path) {
  const idf::Data* value = message.at(path);
  const auto number = value == nullptr ? std::nullopt : value->as_number();
  if (!number) return invalid_argument("occupancy grid: {} is missing or no number", path);
  if (!std::isfinite(*number)) return invalid_argument("occupancy grid: {} is {}", path, *number);
  return *number;
}

Result<int> size_at(const idf::Data& message, std::string_view path) {
  ENGRAM_ASSIGN_OR_RETURN(const double number, number_at(message, path));
  if (!(number >= 1 && number <= static_cast<double>(GridFrame::kMaxCells)))
    return invalid_argument("occupancy grid: {} is {}, needs 1 to {}", path, number,
                            GridFrame::kMaxCells);
  return static_cast<int>(number);
}

}  // namespace

uint8_t cost_of_occupancy(int occupancy) {
  if (occupancy < 0 || occupancy > kFullyOccupied) return kUnknownCost;
  if (occupancy == 0) return kFreeCost;
  if (occupancy == kFullyOccupied) return kLethalCost;
  if (occupancy == kInscribed) return kInscribedCost;
  // Rounded up, so that occupancy_of_cost rounds down to the same occupancy.
  return static_cast<uint8_t>(1 + ((occupancy - 1) * 251 + 96) / 97);
}

int8_t occupancy_of_cost(uint8_t cost) {
  if (cost == kFreeCost) return 0;
  if (cost == kInscribedCost) return kInscribed;
  if (cost == kLethalCost) return kFullyOccupied;
  if (cost == kUnknownCost) return -1;
  return static_cast<int8_t>(1 + (97 * (cost - 1)) / 251);
}

Result<CostMap> map_of_occupancy_grid(const idf::Data& message) {
  CostMap map;
  ENGRAM_ASSIGN_OR_RETURN(map.frame.columns, size_at(message, "info/width"));
  ENGRAM_ASSIGN_OR_RETURN(map.frame.rows, size_at(message, "info/height"));
  ENGRAM_ASSIGN_OR_RETURN(map.frame.resolution_m, number_at(message, "info/resolution"));
  typed::Pose<double> pose;
  ENGRAM_ASSIGN_OR_RETURN(pose.position.x(), number_at(message, "info/origin/position/x"));
  ENGRAM_ASSIGN_OR_RETURN(pose.position.y(), number_at(message, "info/origin/position/y"));
  Eigen::Vector4d xyzw;
  ENGRAM_ASSIGN_OR_RETURN(xyzw[0], number_at(message, "info/origin/orientation/x"));
  ENGRAM_ASSIGN_OR_RETURN(xyzw[1], number_at(message, "info/origin/orientation/y"));
  ENGRAM_ASSIGN_OR_RETURN(xyzw[2], number_at(message, "info/origin/orientation/z"));
  ENGRAM_ASSIGN_OR_RETURN(xyzw[3], number_at(message, "info/origin/orientation/w"));
  // An orientation of zeros is what messages have where nobody set it.
  if (xyzw.norm() > 0) {
    pose.orientation = Eigen::Quaterniond(xyzw);
    if (std::abs(xyzw.norm() - 1) > 0.01)
      return invalid_argument("occupancy grid: info/origin/orientation has a norm of {}, needs 1",
                              xyzw.norm());
    pose.orientation.normalize();
  }
  map.frame.pose_world_map = PlanarPose::of(pose);
  ENGRAM_RETURN_IF_ERROR(map.frame.validate());
  ENGRAM_RETURN_IF_ERROR(read_cells(message.at("data"), map));
  return map;
}

idf::Data occupancy_grid_of_map(const CostMap& map, Time stamp, const std::string& frame_id) {
  constexpr int64_t kSecond = 1'000'000'000;
  const int64_t ns = to_ns(stamp);
  int64_t seconds = ns / kSecond;
  if (ns % kSecond < 0) --seconds;
  const idf::Dict time{{"sec", static_cast<int32_t>(seconds)},
                       {"nanosec", static_cast<int64_t>(ns - seconds * kSecond)}};
  std::vector<int8_t> cells;
  cells.reserve(map.costs.total());
  for (int row = 0; row < map.costs.rows; ++row)
    for (int column = 0; column < map.costs.cols; ++column)
      cells.push_back(occupancy_of_cost(map.costs.at<uint8_t>(row, column)));
  const auto count = static_cast<int64_t>(cells.size());
  const PlanarPose& origin = map.frame.pose_world_map;
  const idf::Dict pose{{"position", idf::Dict{{"x", origin.x_m}, {"y", origin.y_m}, {"z", 0.0}}},
                       {"orientation", idf::Dict{{"x", 0.0},
                                                 {"y", 0.0},
                                                 {"z", std::sin(origin.heading_rad / 2)},
                                                 {"w", std::cos(origin.heading_rad / 2)}}}};
  return idf::Dict{{"header", idf::Dict{{"stamp", time}, {"frame_id", frame_id}}},
                   {"info", idf::Dict{{"map_load_time", time},
                                      {"resolution", static_cast<float>(map.frame.resolution_m)},
                                      {"width", int64_t{map.frame.columns}},
                                      {"height", int64_t{map.frame.rows}},
                                      {"origin", pose}}},
                   {"data", idf::NdArray::take<int8_t>({count}, std::move(cells))}};
}

}  // namespace engram::navigation
