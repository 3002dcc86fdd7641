// SPDX-License-Identifier: Apache-2.0
#include "ltm/reflection/robust.h"

#include <gtest/gtest.h>

namespace engram::ltm {
namespace {

TEST(Robust, QuantilesOfFewAndOfNone) {
  EXPECT_EQ(quantile({}, 0.5), 0);
  EXPECT_EQ(quantile({3}, 0.99), 3);
  EXPECT_EQ(quantile({5, 1, 4, 2, 3}, 0.5), 3);
  EXPECT_EQ(quantile({5, 1, 4, 2, 3}, 0), 1);
  EXPECT_EQ(quantile({5, 1, 4, 2, 3}, 1), 5);
}

TEST(Robust, ASampleIsSpreadOverAll) {
  std::vector<double> values(100'000);
  for (size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i);
  const auto sample = spread_sample(values, 1000);
  EXPECT_EQ(sample.size(), 1000u);
  EXPECT_EQ(sample.front(), 0);
  EXPECT_GT(sample.back(), 99'000);
  EXPECT_EQ(spread_sample({values.data(), 5}).size(), 5u);
}

TEST(Robust, WilsonsIntervalIsThatOfTables) {
  const auto [low, high] = wilson_interval(8, 10);
  EXPECT_NEAR(low, 0.4902, 1e-4);
  EXPECT_NEAR(high, 0.9433, 1e-4);
  EXPECT_EQ(wilson_interval(0, 0), std::pair(0.0, 1.0));
  EXPECT_EQ(wilson_interval(0, 5).first, 0);
  EXPECT_EQ(wilson_interval(5, 5).second, 1);
}

}  // namespace
}  // namespace engram::ltm
