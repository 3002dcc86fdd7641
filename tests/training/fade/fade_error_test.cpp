// SPDX-License-Identifier: Apache-2.0
#include "training/fade/fade_error.h"

#include <gtest/gtest.h>

#include <cmath>

namespace engram::training {
namespace {

TEST(FadeError, AStepMayTakeWhatIsLeft) {
  EXPECT_DOUBLE_EQ(max_step_mse(0, 40), 40);
  EXPECT_EQ(max_step_mse(40, 40), 0);
  EXPECT_EQ(max_step_mse(50, 40), 0);
  const double step = max_step_mse(16, 40);
  EXPECT_NEAR(16 + step + 2 * kMaxErrorCorrelation * std::sqrt(16 * step), 40, 1e-9);
}

TEST(FadeError, OfRecordedValuesIsMeasured) {
  const ltm::LatentQuality quality = joined_quality({}, {40, 0.5}, 32);
  EXPECT_EQ(quality.error.image_mse, 40);
  EXPECT_FALSE(quality.bound.has_value());
  EXPECT_EQ(quality.faded_to_db, 32);
}

TEST(FadeError, IsRoundedUp) {
  for (const double mse : {1e-9, 0.3, 1.0, 40.123, 65025.0, 3e8}) {
    const ltm::LatentQuality quality = joined_quality({}, {mse, mse}, 32);
    EXPECT_GE(quality.error.image_mse, mse);
    EXPECT_LE(quality.error.image_mse, mse * (1 + 1.0 / 128));
    EXPECT_EQ(quality.error.number_mse, quality.error.image_mse);
  }
  EXPECT_EQ(joined_quality({}, {0, 0}, 32).error.image_mse, 0);
}

TEST(FadeError, OfLatentsAddsUp) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const ltm::LatentQuality once = joined_quality(ltm::LatentQuality{{16, nan}}, {9, nan}, 32);
  EXPECT_DOUBLE_EQ(once.error.image_mse, 25) << "as independent errors do";
  ASSERT_TRUE(once.bound.has_value());
  EXPECT_DOUBLE_EQ(once.bound->image_mse, 49) << "(4 + 3) squared";
  EXPECT_TRUE(std::isnan(once.error.number_mse));
  const ltm::LatentQuality twice = joined_quality(once, {9, nan}, 28);
  EXPECT_DOUBLE_EQ(twice.error.image_mse, 34);
  EXPECT_DOUBLE_EQ(twice.bound->image_mse, 100) << "nothing fades twice without its total bound";
}

}  // namespace
}  // namespace engram::training
