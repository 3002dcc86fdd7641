// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>

#include "ltm/core/status.h"
#include "ltm/idf/ndarray.h"
#include "ltm/idf/type.h"
#include "ltm/typed/convert_value.h"
#include "ltm/typed/defaults.h"

namespace engram::typed {

/// The number of fields of a point, as idf::field_count.
[[nodiscard]] constexpr int fields_of(idf::PointType point) {
  switch (point) {
    case idf::PointType::kXyz:
      return 3;
    case idf::PointType::kXyzi:
    case idf::PointType::kXyzl:
      return 4;
    case idf::PointType::kXyzRgb:
    case idf::PointType::kXyzNormal:
      return 6;
    case idf::PointType::kXyzRgba:
    case idf::PointType::kXyzRgbl:
      return 7;
    case idf::PointType::kXyzRgbNormal:
      break;
  }
  return 9;
}

/// Immutable points that are shared with the value they came from: copying is O(1), and neither
/// writing them into a value nor reading them from one copies a point.
///
/// Shape: float32 [points, fields], row-major; fields as in idf::PointType.
/// Unit: m for x y z, 0..255 for colours.
/// Threading: immutable except for assignment.
template <idf::PointType kPoint>
class PointCloud {
 public:
  static constexpr int kFields = fields_of(kPoint);
  using Points = Eigen::Matrix<float, Eigen::Dynamic, kFields, Eigen::RowMajor>;

  /// A cloud without points.
  PointCloud() : array_(filled<float>({0, kFields})) {}

  /// Takes the points without copying them.
  explicit PointCloud(Points points) {
    auto owner = std::make_shared<const Points>(std::move(points));
    const auto bytes = std::as_bytes(std::span(owner->data(), static_cast<size_t>(owner->size())));
    const int64_t count = owner->rows();
    auto array = idf::NdArray::create(idf::ElementType::kFloat32, {count, kFields},
                                      Buffer(std::move(owner), bytes));
    ENGRAM_CHECK(array.ok(), "{}", array.status().message());
    array_ = std::move(*array);
  }

  /// `count` points at the origin.
  static PointCloud zeros(int64_t count) { return PointCloud(Points::Zero(count, kFields)); }

  /// Shares the array.
  /// Errors: kInvalidArgument unless it is float32 [points, kFields].
  static Result<PointCloud> create(idf::NdArray array) {
    const idf::Shape& shape = array.shape();
    if (array.type() != idf::ElementType::kFloat32 || shape.size() != 2 || shape[1] != kFields)
      return invalid_argument("point cloud {}: found {} {}, needs float32 [*, {}]",
                              idf::to_string(kPoint), idf::to_string(array.type()),
                              idf::to_string(shape), kFields);
    PointCloud cloud;
    cloud.array_ = std::move(array);
    return cloud;
  }

  [[nodiscard]] int64_t count() const { return array_.shape()[0]; }

  /// Valid as long as this cloud or a copy of it lives.
  [[nodiscard]] Eigen::Map<const Points> points() const {
    return {array_.values<float>().data(), count(), kFields};
  }

  [[nodiscard]] const idf::NdArray& array() const { return array_; }

 private:
  idf::NdArray array_;
};

template <idf::PointType kPoint>
struct Convert<PointCloud<kPoint>> {
  using Cloud = PointCloud<kPoint>;

  static idf::Data write(const Cloud& value, const idf::Type&) { return value.array(); }

  static bool read(const idf::Data& data, const idf::Type& type, Cloud& value) {
    const auto* found = data.get_if<idf::NdArray>();
    const auto* needed = type.get_if<idf::types::PointCloud>();
    if (found == nullptr || needed == nullptr) return false;
    auto cloud = Cloud::create(*found);
    if (!cloud.ok()) return false;
    value = std::move(*cloud);
    return needed->count == idf::kFreeSize || needed->count == value.count();
  }

  static bool equal(const Cloud& a, const Cloud& b) { return a.array() == b.array(); }
};

}  // namespace engram::typed
