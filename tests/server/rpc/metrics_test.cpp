// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/metrics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <thread>

namespace engram::server {
namespace {

using Counts = std::vector<uint64_t>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Counter, Counts) {
  Counter counter;
  counter.add();
  counter.add(41);
  EXPECT_EQ(counter.value(), 42u);
}

TEST(Gauge, IsWhatItWasSetTo) {
  Gauge gauge;
  gauge.set(2.5);
  gauge.add(-4);
  EXPECT_EQ(gauge.value(), -1.5);
}

TEST(Histogram, CountsWhatIsAtMostEachBound) {
  Histogram histogram({1, 2, 4});
  for (const double number : {-5.0, 1.0, 1.5, 2.0, 3.0, 9.0}) histogram.observe(number);
  EXPECT_EQ(histogram.cumulative_counts(), (Counts{2, 4, 5, 6}));
  EXPECT_EQ(histogram.sum(), 11.5);
}

TEST(Histogram, KeepsItsSumWhereNumbersAreNotFinite) {
  Histogram histogram({1});
  for (const double number : {0.5, kInfinity, -kInfinity, std::numeric_limits<double>::quiet_NaN()})
    histogram.observe(number);
  EXPECT_EQ(histogram.cumulative_counts(), (Counts{1, 4}));
  EXPECT_EQ(histogram.sum(), 0.5);
}

TEST(Histogram, CountsAllWithoutBounds) {
  Histogram histogram({});
  histogram.observe(3);
  EXPECT_EQ(histogram.cumulative_counts(), Counts{1});
}

TEST(HistogramDeathTest, NeedsBoundsThatIncrease) {
  EXPECT_DEATH(Histogram({1, 1}), "bound 1 is 1 after 1");
  EXPECT_DEATH(Histogram({kInfinity}), "bound 0 is inf");
}

TEST(Metrics, LoseNothingBetweenThreads) {
  constexpr int kThreads = 4;
  constexpr int kEach = 20'000;
  Counter counter;
  Gauge gauge;
  Histogram histogram(latency_bounds());
  {
    std::vector<std::jthread> threads;
    for (int thread = 0; thread < kThreads; ++thread)
      threads.emplace_back([&] {
        for (int i = 0; i < kEach; ++i) {
          counter.add();
          gauge.add(i % 2 == 0 ? 1 : -1);
          histogram.observe(i % 2);
          if (i % 100 != 0) continue;
          EXPECT_TRUE(std::ranges::is_sorted(histogram.cumulative_counts()));
        }
      });
  }
  EXPECT_EQ(counter.value(), static_cast<uint64_t>(kThreads * kEach));
  EXPECT_EQ(gauge.value(), 0);
  EXPECT_EQ(histogram.cumulative_counts().back(), static_cast<uint64_t>(kThreads * kEach));
  EXPECT_EQ(histogram.sum(), kThreads * kEach / 2);
}

}  // namespace
}  // namespace engram::server
