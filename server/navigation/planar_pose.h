// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "ltm/idf/data.h"
#include "ltm/typed/pose.h"

namespace engram::navigation {

/// A place on the floor and a direction.
///
/// Unit: m, m, rad. Frame: of what it is a pose in; `heading_rad` turns from x to y.
struct PlanarPose {
  double x_m = 0;
  double y_m = 0;
  double heading_rad = 0;

  [[nodiscard]] Eigen::Vector2d position() const { return {x_m, y_m}; }

  /// Takes a point of this frame to the outer one, and back.
  [[nodiscard]] Eigen::Vector2d outward(const Eigen::Vector2d& point) const;
  [[nodiscard]] Eigen::Vector2d inward(const Eigen::Vector2d& point) const;

  /// The pose of `inner`, which is given in this frame, in the outer one.
  [[nodiscard]] PlanarPose times(const PlanarPose& inner) const;

  [[nodiscard]] bool is_finite() const;

  /// An ndarray float64 [3].
  [[nodiscard]] idf::NdArray to_array() const;

  /// Nothing where it is no float64 [3] of finite numbers.
  [[nodiscard]] static std::optional<PlanarPose> from_array(const idf::NdArray& array);

  /// The shadow of a pose in space: its position, and where its x axis points. Where the x axis
  /// points up or down, the y axis tells the heading.
  [[nodiscard]] static PlanarPose of(const typed::Pose<double>& pose);

  friend bool operator==(const PlanarPose&, const PlanarPose&) = default;
};

/// The same angle in (-pi, pi].
[[nodiscard]] double wrapped(double angle_rad);

}  // namespace engram::navigation
