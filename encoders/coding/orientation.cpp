// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/orientation.h"

#include <algorithm>
#include <cmath>

namespace engram::encoders {

Quaternion multiply(const Quaternion& a, const Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
          a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

Quaternion conjugate(const Quaternion& q) {
  return {q[0], -q[1], -q[2], -q[3]};
}

Quaternion canonical(const Quaternion& q) {
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  const auto first = std::ranges::find_if(q, [](double part) { return part != 0; });
  const double scale = (first != q.end() && *first < 0 ? -1.0 : 1.0) / length;
  return {q[0] * scale, q[1] * scale, q[2] * scale, q[3] * scale};
}

bool is_unit(std::span<const double, 4> q) {
  const double squared = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  return std::abs(squared - 1) < 1e-5;  // False for NaN.
}

RotationParameters to_parameters(const Quaternion& q) {
  const Quaternion c = canonical(q);
  return {c[1] / (1 + c[0]), c[2] / (1 + c[0]), c[3] / (1 + c[0])};
}

Quaternion from_parameters(const RotationParameters& p) {
  const double squared = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
  const double scale = 1 / (1 + squared);
  return {(1 - squared) * scale, 2 * p[0] * scale, 2 * p[1] * scale, 2 * p[2] * scale};
}

Quaternion extrapolate(const Quaternion& before, const Quaternion& last, int eighths) {
  RotationParameters change = to_parameters(multiply(last, conjugate(before)));
  for (double& part : change) part *= eighths / 8.0;
  return canonical(multiply(from_parameters(change), last));
}

double angle_between_rad(const Quaternion& a, const Quaternion& b) {
  const Quaternion d = multiply(a, conjugate(b));
  const double sine = std::sqrt(d[1] * d[1] + d[2] * d[2] + d[3] * d[3]);
  return 2 * std::atan2(sine, std::abs(d[0]));
}

// The angle changes by at most 4 times the change of the parameters, and rounding moves these by up
// to sqrt(3) / 2 steps.
double parameter_step(double bound_rad) {
  return 0.2886 * bound_rad;
}

}  // namespace engram::encoders
