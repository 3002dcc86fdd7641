// SPDX-License-Identifier: Apache-2.0
#include "training/measure/quality_sums.h"

#include <gtest/gtest.h>

namespace engram::training {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(CoverageSums, TellHowFarBoundsLieFromWhatIsExpected) {
  PredictionSums sums;
  sums.add({{100, 4}, {1000, 16}}, {500, 20});
  sums.add({{100, 1}, {100, 4}}, {50, 2});
  const auto [images, numbers] = sums.bound_coverage();
  EXPECT_EQ(images.predictions, 2u);
  EXPECT_EQ(images.within, 2u);
  EXPECT_EQ(images.vacuous, 0u);
  EXPECT_NEAR(images.width_db, 5, 1e-9);  // 10 dB and 0 dB.
  EXPECT_NEAR(images.mean_bound, (psnr_db(1000) + psnr_db(100)) / 2, 1e-9);
  EXPECT_EQ(numbers.within, 1u);
  EXPECT_NEAR(numbers.width_db, 10 * std::log10(4), 1e-9);
}

TEST(CoverageSums, CountABoundAsAtMostTheLargestError) {
  PredictionSums sums, more;
  sums.add({{1000, kNaN}, {1e7, kNaN}}, {900, kNaN});
  more.add({{1000, kNaN}, {encoders::kMaxImageMse, kNaN}}, {900, kNaN});
  sums.add(more);
  const Coverage images = sums.bound_coverage().images;
  EXPECT_EQ(images.within, 2u);
  EXPECT_EQ(images.vacuous, 2u);
  EXPECT_DOUBLE_EQ(images.mean_bound, 0);  // 1e7 would be -21.9 dB.
  EXPECT_NEAR(images.width_db, psnr_db(1000), 1e-9);
}

TEST(CoverageSums, HaveNoWidthWhereNothingIsExpected) {
  PredictionSums sums;
  sums.add({{kNaN, 0}, {kNaN, 0}}, {kNaN, 0});
  const Coverage numbers = sums.bound_coverage().numbers;
  EXPECT_EQ(numbers.within, 1u);
  EXPECT_TRUE(std::isnan(numbers.width_db));
  EXPECT_TRUE(std::isnan(sums.bound_coverage().images.width_db));
}

}  // namespace
}  // namespace engram::training
