// SPDX-License-Identifier: Apache-2.0
#include "ltm/prediction/rotation.h"

#include <cmath>

#include "ltm/core/check.h"

namespace engram::ltm {

namespace {

constexpr double kTolerance = 1e-3;

size_t columns_of(RotationForm form) {
  return form == RotationForm::kPose ? 4 : 3;
}

std::optional<Eigen::Quaterniond> from_quaternion(std::span<const double> elements) {
  const Eigen::Quaterniond found(elements[0], elements[1], elements[2], elements[3]);
  if (!(std::abs(found.norm() - 1) <= kTolerance)) return std::nullopt;  // Also for NaN.
  return found.normalized();
}

std::optional<Eigen::Quaterniond> from_matrix(std::span<const double> elements, size_t columns) {
  Eigen::Matrix3d matrix;
  for (size_t row = 0; row < 3; ++row)
    for (size_t column = 0; column < 3; ++column)
      matrix(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) =
          elements[row * columns + column];
  const double largest =
      (matrix * matrix.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!matrix.allFinite() || !(largest <= kTolerance) || !(matrix.determinant() > 0))
    return std::nullopt;
  return Eigen::Quaterniond(matrix).normalized();
}

}  // namespace

std::optional<Eigen::Quaterniond> rotation_of(RotationForm form, std::span<const double> elements) {
  const size_t columns = columns_of(form);
  if (form == RotationForm::kQuaternion) {
    ENGRAM_CHECK(elements.size() == 4, "{} elements", elements.size());
    return from_quaternion(elements);
  }
  ENGRAM_CHECK(elements.size() == columns * columns, "{} elements", elements.size());
  if (form == RotationForm::kPose &&
      (elements[12] != 0 || elements[13] != 0 || elements[14] != 0 || elements[15] != 1))
    return std::nullopt;
  return from_matrix(elements, columns);
}

void write_rotation(RotationForm form, const Eigen::Quaterniond& rotation,
                    std::span<double> elements) {
  if (form == RotationForm::kQuaternion) {
    elements[0] = rotation.w();
    elements[1] = rotation.x();
    elements[2] = rotation.y();
    elements[3] = rotation.z();
    return;
  }
  const size_t columns = columns_of(form);
  const Eigen::Matrix3d matrix = rotation.toRotationMatrix();
  for (size_t row = 0; row < 3; ++row)
    for (size_t column = 0; column < 3; ++column)
      elements[row * columns + column] =
          matrix(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
}

Eigen::Vector3d turn_between(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) {
  const Eigen::Quaterniond change = to * from.conjugate();
  const double sine = change.vec().norm();
  if (!(sine > 0)) return Eigen::Vector3d::Zero();
  const double sign = change.w() < 0 ? -1 : 1;
  return change.vec() * (sign * 2 * std::atan2(sine, std::abs(change.w())) / sine);
}

Eigen::Quaterniond turned(const Eigen::Quaterniond& from, const Eigen::Vector3d& turn_rad) {
  const double angle = turn_rad.norm();
  if (!(angle > 0)) return from;
  return (Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn_rad / angle)) * from).normalized();
}

}  // namespace engram::ltm
