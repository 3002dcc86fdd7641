// SPDX-License-Identifier: Apache-2.0
#include "encoders/training_curve.h"

#include <algorithm>

namespace engram::encoders {

TrainingCurve::TrainingCurve(std::vector<CurvePoint> points) : points_(std::move(points)) {
  const auto of_one_phase = [](const CurvePoint& a, const CurvePoint& b) {
    return a.phase == b.phase;
  };
  const auto first = std::ranges::adjacent_find(points_, of_one_phase);
  if (first != points_.end()) stride_ = std::max<int64_t>(1, (first + 1)->step - first->step);
}

void TrainingCurve::add(const CurvePoint& point) {
  if (point.step % stride_ != 0) return;
  points_.push_back(point);
  while (points_.size() > kMaxPoints) {
    stride_ *= 2;
    std::erase_if(points_, [&](const CurvePoint& one) { return one.step % stride_ != 0; });
  }
}

}  // namespace engram::encoders
