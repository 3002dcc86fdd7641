// SPDX-License-Identifier: Apache-2.0
#include "ltm/prediction/number_series.h"

#include <gtest/gtest.h>

#include <limits>

namespace engram::ltm {
namespace {

using std::chrono::milliseconds;

Time at_ms(int64_t ms) {
  return Time(milliseconds(ms));
}

TEST(NumberSeries, KnowsItsStepAndItsRuns) {
  NumberSeries series(1);
  EXPECT_EQ(series.step(), Duration(0));
  for (const int64_t ms : {0, 99, 201, 300, 500, 10'000, 10'100})
    ASSERT_TRUE(series.add(at_ms(ms), std::vector{1.0}).ok());
  EXPECT_EQ(series.step(), milliseconds(100));
  EXPECT_EQ(series.run_start(4), 0u) << "one row is missing: no pause";
  EXPECT_EQ(series.run_start(6), 5u);
  EXPECT_EQ(series.steps_in(milliseconds(260)), 3u);
  EXPECT_EQ(series.steps_in(milliseconds(1)), 1u);
}

TEST(NumberSeries, RefusesWhatIsNoNextRow) {
  NumberSeries series(2);
  ASSERT_TRUE(series.add(at_ms(5), std::vector{1.0, 2.0}).ok());
  EXPECT_FALSE(series.add(at_ms(6), std::vector{1.0}).ok());
  EXPECT_FALSE(series.add(at_ms(5), std::vector{1.0, 2.0}).ok());
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(series.add(at_ms(6), std::vector{1.0, nothing}).ok());
  EXPECT_EQ(series.rows(), 1u);
}

TEST(NumberSeries, ForgetsTheOldestRows) {
  NumberSeries series(1, 10);
  for (int i = 0; i < 1000; ++i) {
    const int64_t pause_ms = i >= 995 ? 5000 : 0;
    ASSERT_TRUE(series.add(at_ms(100 * i + pause_ms), std::vector{double(i)}).ok());
    EXPECT_LE(series.rows(), 20u);
    EXPECT_GE(series.rows(), std::min<size_t>(static_cast<size_t>(i) + 1, 10));
    EXPECT_EQ(series.row(series.rows() - 1)[0], i);
    EXPECT_LE(series.run_start(series.rows() - 1), series.rows() - 1);
  }
  EXPECT_EQ(series.added(), 1000u);
  EXPECT_EQ(series.row(series.run_start(series.rows() - 1))[0], 995);
}

}  // namespace
}  // namespace engram::ltm
