// SPDX-License-Identifier: Apache-2.0
#include "ltm/context/view_planes.h"

#include <algorithm>

namespace engram::ltm {

// Why a margin of 32 roundings is enough. Let r = 2^-24 be the rounding of a float, N the square of
// the orientation's length, A the largest sum of the absolute coefficients of a plane, and D the
// distance |x| + |y| + |z| of a place. The entries of the rotation, scaled by N, are wrong by 6 r N
// at most, the coefficients of a turned plane by 10 r A N, and a height by 14 r A N D. So a height
// that is more than 32 r A N D away from 0 has the right sign, and its true value is more than
// 18 r A N D away from 0.
//
// The exact computation says the same. It is wrong by some 2^-50 of A N D, far less than what is
// left of the margin, as long as its z is not 0. A place that is above all planes has
// width * z > 36 r A N D, and A is at least half the width: z is far enough from 0. One that is
// below a plane is outside if z is 0 or less, and if it is more, then the sign of the height
// decides.
LensPlanes planes_of(const Intrinsics& lens) {
  constexpr double kMargin = 32 * 0x1p-24;
  constexpr double kMinSide = 1e-6;
  constexpr double kMaxSum = 1e9;
  const std::array<double, 4> x{lens.fx, -lens.fx, 0, 0};
  const std::array<double, 4> y{0, 0, lens.fy, -lens.fy};
  const std::array<double, 4> z{lens.cx + 0.5, lens.width - 0.5 - lens.cx, lens.cy + 0.5,
                                lens.height - 0.5 - lens.cy};
  LensPlanes planes;
  double sum = 0;
  for (size_t i = 0; i < x.size(); ++i)
    sum = std::max(sum, std::abs(x[i]) + std::abs(y[i]) + std::abs(z[i]));
  const bool is_finite = std::isfinite(lens.fx) && std::isfinite(lens.fy) &&
                         std::isfinite(lens.cx) && std::isfinite(lens.cy);
  if (!is_finite || !(lens.width > kMinSide && lens.height > kMinSide && sum < kMaxSum))
    return planes;
  for (size_t i = 0; i < x.size(); ++i) {
    planes.x[i] = static_cast<float>(x[i]);
    planes.y[i] = static_cast<float>(y[i]);
    planes.z[i] = static_cast<float>(z[i]);
  }
  planes.margin = static_cast<float>(kMargin * sum);
  return planes;
}

ViewPlanes turned(const LensPlanes& lens, const double* position, const double* orientation) {
  constexpr float kMinSquare = 0.25F;
  constexpr float kMaxSquare = 4;
  const auto w = static_cast<float>(orientation[0]);
  const auto x = static_cast<float>(orientation[1]);
  const auto y = static_cast<float>(orientation[2]);
  const auto z = static_cast<float>(orientation[3]);
  const float ww = w * w, xx = x * x, yy = y * y, zz = z * z;
  const float square = ww + xx + yy + zz;
  ViewPlanes view;
  view.position = {position[0], position[1], position[2]};
  // Floats tell nothing of one that is hardly an orientation; the exact computation tells it.
  if (!(square > kMinSquare && square < kMaxSquare)) return view;
  const float xy = 2 * x * y, xz = 2 * x * z, yz = 2 * y * z;
  const float wx = 2 * w * x, wy = 2 * w * y, wz = 2 * w * z;
  view.x = lens.x * (ww + xx - yy - zz) + lens.y * (xy - wz) + lens.z * (xz + wy);
  view.y = lens.x * (xy + wz) + lens.y * (ww - xx + yy - zz) + lens.z * (yz - wx);
  view.z = lens.x * (xz - wy) + lens.y * (yz + wx) + lens.z * (ww - xx - yy + zz);
  view.margin = lens.margin * square;
  return view;
}

}  // namespace engram::ltm
