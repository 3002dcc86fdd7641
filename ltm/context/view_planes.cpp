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

// Intervals for what glance_at() has numbers for. The rotation is that of a normalised orientation,
// so N is 1; the coefficients are wrong by 6 r A at most, the distances by 2 r D, and a height by
// 14 r A D, where D is the largest distance of all. A height beyond 64 r A D has the right sign for
// each place in each image, and more than 36 r A D is left of it, which suffices as above.
Glance glance_at_run(const LensPlanes& lens, const RunBounds<12>::Bounds& cameras,
                     const RunBounds<3>::Bounds& places) {
  constexpr float kMinSize = 1e-9F;
  constexpr float kMaxSize = 1e15F;
  float size = 0;
  for (size_t i = 0; i < 12; ++i) size += std::abs(cameras.low[i]) + std::abs(cameras.high[i]);
  for (size_t i = 0; i < 3; ++i) size += std::abs(places.low[i]) + std::abs(places.high[i]);
  if (!(size < kMaxSize)) return Glance::kUnsure;
  const Sides zero{};
  const std::array<Sides, 3> of_lens{lens.x, lens.y, lens.z};
  Sides low{};
  Sides high{};
  float distance = 0;
  for (size_t axis = 0; axis < 3; ++axis) {
    Sides lowest{};
    Sides highest{};
    for (size_t i = 0; i < 3; ++i) {
      const Sides positive = of_lens[i] > zero ? of_lens[i] : zero;
      const Sides negative = of_lens[i] > zero ? zero : of_lens[i];
      const float from = cameras.low[3 * axis + i];
      const float to = cameras.high[3 * axis + i];
      lowest += positive * from + negative * to;
      highest += positive * to + negative * from;
    }
    const float from = places.low[axis] - cameras.high[9 + axis];
    const float to = places.high[axis] - cameras.low[9 + axis];
    const std::array<Sides, 4> products{lowest * from, lowest * to, highest * from, highest * to};
    Sides smallest = products[0];
    Sides largest = products[0];
    for (const Sides& product : products) {
      smallest = product < smallest ? product : smallest;
      largest = product > largest ? product : largest;
    }
    low += smallest;
    high += largest;
    distance += std::max(std::abs(from), std::abs(to));
  }
  const float margin = 2 * lens.margin * distance;
  if (!(distance > kMinSize)) return Glance::kUnsure;
  if (holds_for_all(low > margin)) return Glance::kInside;
  return holds_for_all(high >= -margin) ? Glance::kUnsure : Glance::kOutside;
}

}  // namespace engram::ltm
