// SPDX-License-Identifier: Apache-2.0
#include "viewer/shown_cloud.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "ltm/core/check.h"
#include "ltm/idf/element_visit.h"

namespace engram::viewer {

namespace {

using CloudPoint = std::array<float, 3>;

/// Keeps `max_points` of the points that `point_at` finds among `count` places, evenly spread.
template <typename PointAt>
ShownCloud spread(size_t count, size_t max_points, const PointAt& point_at) {
  ShownCloud cloud;
  for (size_t i = 0; i < count; ++i) cloud.known += point_at(i) ? 1 : 0;
  const uint64_t kept = std::min<uint64_t>(cloud.known, max_points);
  cloud.points.reserve(3 * kept);
  uint64_t seen = 0;
  for (size_t i = 0; i < count && kept > 0; ++i) {
    const std::optional<CloudPoint> point = point_at(i);
    if (!point) continue;
    // A point is kept when the share that is due reaches the next whole number.
    const bool is_due = (seen + 1) * kept / cloud.known > seen * kept / cloud.known;
    if (is_due) cloud.points.insert(cloud.points.end(), point->begin(), point->end());
    ++seen;
  }
  return cloud;
}

std::optional<CloudPoint> finite_point(double x, double y, double z) {
  const CloudPoint point{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
  const bool is_finite =
      std::ranges::all_of(point, [](float number) { return std::isfinite(number); });
  return is_finite ? std::optional(point) : std::nullopt;
}

template <typename T>
ShownCloud unprojected(const idf::NdArray& depth, const DepthCamera& camera, double unit_m,
                       size_t max_points) {
  const auto values = depth.values<T>();
  const auto width = static_cast<size_t>(depth.shape()[1]);
  return spread(values.size(), max_points, [&](size_t i) -> std::optional<CloudPoint> {
    const double z = static_cast<double>(values[i]) * unit_m;
    // Written so that NaN has no point either.
    if (!(z > 0)) return std::nullopt;
    return finite_point((static_cast<double>(i % width) - camera.cx) / camera.fx * z,
                        (static_cast<double>(i / width) - camera.cy) / camera.fy * z, z);
  });
}

}  // namespace

ShownCloud cloud_of_depth(const idf::NdArray& depth, const DepthCamera& camera, double unit_m,
                          size_t max_points) {
  ENGRAM_CHECK(depth.shape().size() == 3, "depth of shape {}", idf::to_string(depth.shape()));
  if (depth.type() == idf::ElementType::kUInt16)
    return unprojected<uint16_t>(depth, camera, unit_m, max_points);
  return unprojected<float>(depth, camera, unit_m, max_points);
}

ShownCloud cloud_of_rows(const idf::NdArray& rows, size_t max_points) {
  ENGRAM_CHECK(rows.shape().size() == 2 && rows.shape()[1] >= 3, "rows of shape {}",
               idf::to_string(rows.shape()));
  const auto columns = static_cast<size_t>(rows.shape()[1]);
  return idf::visit_element_type(rows.type(), [&]<typename T>(T) {
    const auto values = rows.values<T>();
    return spread(static_cast<size_t>(rows.shape()[0]), max_points, [&](size_t i) {
      const auto number = [&](size_t column) {
        return static_cast<double>(values[i * columns + column]);
      };
      return finite_point(number(0), number(1), number(2));
    });
  });
}

}  // namespace engram::viewer
