// SPDX-License-Identifier: Apache-2.0
#include "training/night/parallel_speed.h"

#include <gtest/gtest.h>

namespace engram::training {
namespace {

using Groups = std::vector<std::vector<size_t>>;

TEST(SplitInTwo, GivesBothAboutTheSame) {
  EXPECT_EQ(split_in_two(std::vector<double>{0.2, 0.5, 0.3}), (Groups{{1}, {2, 0}}));
  EXPECT_EQ(split_in_two(std::vector<double>{0.1, 0.1, 0.5, 0.3}), (Groups{{2}, {3, 0, 1}}));
  EXPECT_EQ(split_in_two(std::vector<double>{0.3, 0.3, 0.2, 0.2, 0.2}),
            (Groups{{0, 2, 4}, {1, 3}}));
  EXPECT_EQ(split_in_two(std::vector<double>{1}), (Groups{{0}, {}}));
}

TEST(TwoAreQuicker, WhereTheWorkIsEvenlyDividedAndThreadsGainLittle) {
  // Two threads gain 1.6 times, two processes 1.9 times.
  const ParallelSpeed speed{1.6, 1.9};
  EXPECT_TRUE(two_are_quicker(std::vector<double>{0.5, 0.5}, speed));
  EXPECT_FALSE(two_are_quicker(std::vector<double>{0.95, 0.05}, speed)) << "one would idle";
  EXPECT_TRUE(two_are_quicker(std::vector<double>{0.95, 0.05}, {0.9, 1.9}))
      << "threads only hinder";
  EXPECT_FALSE(two_are_quicker(std::vector<double>{1}, speed)) << "there is one alone";
  EXPECT_FALSE(two_are_quicker(std::vector<double>{0.5, 0.5}, {2.0, 1.9}));
}

TEST(ParallelSpeed, IsMeasuredBothWays) {
  const ParallelSpeed speed = measure_parallel_speed();
  EXPECT_GT(speed.one_of_two, 0);
  EXPECT_GT(speed.two_of_one, 0);
}

}  // namespace
}  // namespace engram::training
