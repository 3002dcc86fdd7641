// SPDX-License-Identifier: Apache-2.0
#include "encoders/training_curve.h"

#include <gtest/gtest.h>

namespace engram::encoders {
namespace {

CurvePoint point(int32_t phase, int64_t step) {
  return {phase, step, static_cast<float>(step), 1.0f / static_cast<float>(step + 1), 30, 200};
}

TEST(TrainingCurve, KeepsEveryStepOfAShortTraining) {
  TrainingCurve curve;
  for (int64_t step = 0; step < 40; ++step) curve.add(point(0, step));
  for (int64_t step = 0; step < 10; ++step) curve.add(point(1, step));
  ASSERT_EQ(curve.points().size(), 50U);
  EXPECT_EQ(curve.points()[49], point(1, 9));
}

TEST(TrainingCurve, StaysShortAndSpansALongTraining) {
  TrainingCurve curve;
  for (int64_t step = 0; step < 100'000; ++step) curve.add(point(0, step));
  for (int64_t step = 0; step < 30'000; ++step) curve.add(point(1, step));
  const auto& points = curve.points();
  EXPECT_LE(points.size(), TrainingCurve::kMaxPoints);
  EXPECT_GT(points.size(), TrainingCurve::kMaxPoints / 2 - 2);
  EXPECT_EQ(points.front(), point(0, 0));
  EXPECT_EQ(points.back().phase, 1);
  EXPECT_GT(points.back().step, 25'000);
}

TEST(TrainingCurve, GoesOnAsIfItHadNotStopped) {
  for (const int64_t stop : {1, 70, 1000, 5000}) {
    TrainingCurve whole, before;
    for (int64_t step = 1; step < 9000; ++step) whole.add(point(step < 4000 ? 0 : 1, step));
    for (int64_t step = 1; step < stop; ++step) before.add(point(step < 4000 ? 0 : 1, step));
    TrainingCurve after(before.points());
    for (int64_t step = stop; step < 9000; ++step) after.add(point(step < 4000 ? 0 : 1, step));
    EXPECT_EQ(after.points(), whole.points()) << "stopped at " << stop;
  }
}

}  // namespace
}  // namespace engram::encoders
