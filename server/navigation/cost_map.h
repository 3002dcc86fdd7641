// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/idf/data.h"
#include "server/navigation/grid_frame.h"
#include "server/navigation/obstacle.h"

namespace engram::navigation {

// The costs of Nav2 and of costmap_2d.
inline constexpr uint8_t kFreeCost = 0;
inline constexpr uint8_t kInscribedCost = 253;  ///< The robot would touch an obstacle.
inline constexpr uint8_t kLethalCost = 254;     ///< An obstacle is there.
inline constexpr uint8_t kUnknownCost = 255;

/// How costs follow from distances.
struct CostRules {
  /// The robot is a disc: its middle stays at least this far from obstacles. Unit: m.
  double robot_radius_m = 0.3;
  /// What it keeps beyond that. A cell is blocked by where its middle is, so a robot may be nearer
  /// by up to 1.42 cells: 0.1 m leaves 3 cm at a resolution of 5 cm.
  double clearance_m = 0.1;
  /// Costs fall to 0 at this distance from an obstacle. A larger one costs time: the window of a
  /// change grows with it on all sides.
  double inflation_radius_m = 0.9;
  /// Costs fall by e over this reciprocal distance. Unit: 1/m.
  double falloff_per_m = 3;

  [[nodiscard]] double inscribed_m() const { return robot_radius_m + clearance_m; }

  /// The cost of a cell at this distance from the next obstacle.
  [[nodiscard]] uint8_t cost(double distance_m) const;

  /// Errors: kInvalidArgument naming what is not positive or contradicts the rest.
  [[nodiscard]] Status validate() const;
};

/// Something that the map should have told of and does not.
struct LeftOutThing {
  ltm::MemoryId snapshot;
  std::string reason;

  friend bool operator==(const LeftOutThing&, const LeftOutThing&) = default;
};

/// Where the middle of the robot may be, and what makes it so.
///
/// Threading: immutable except for assignment; copies share the costs.
/// Source: docs/navigation.md.
struct CostMap {
  GridFrame frame;
  cv::Mat costs;  ///< CV_8UC1 [rows, columns].
  double inscribed_m = 0;
  double inflation_m = 0;
  int64_t version = 0;  ///< Counts the maps of its provider.
  std::vector<Obstacle> obstacles;
  std::vector<LeftOutThing> left_out;
  ltm::MemoryId id;  ///< Where it is in the memory; empty: nowhere.

  /// The cost at a point of the world; unknown outside of the map.
  [[nodiscard]] uint8_t cost_at(const Eigen::Vector2d& point) const;

  /// Whether the middle of the robot may be there. What is unknown is not free.
  [[nodiscard]] bool is_free(const Eigen::Vector2d& point) const {
    return cost_at(point) < kInscribedCost;
  }

  /// A navigation::CostMap.
  [[nodiscard]] idf::Data to_data() const;

  /// Reads what to_data wrote; safe on hostile values. Shares the bytes of the costs.
  /// Errors: kInvalidArgument naming the member, what was found and what was needed.
  static Result<CostMap> from_data(const idf::Data& data, ltm::MemoryId id = {});
};

/// "chair_1", "chair_1 and table", "chair_1, table and 3 more".
[[nodiscard]] std::string names_of(const std::vector<Obstacle>& obstacles);

}  // namespace engram::navigation
