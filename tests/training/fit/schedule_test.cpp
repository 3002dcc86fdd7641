// SPDX-License-Identifier: Apache-2.0
#include "training/fit/schedule.h"

#include <gtest/gtest.h>

namespace engram::training {
namespace {

TEST(LearningRate, RisesThenFallsToNearlyNothing) {
  EXPECT_LT(learning_rate_share(0), 0.01);
  EXPECT_GT(learning_rate_share(0.02), 0.98);
  EXPECT_NEAR(learning_rate_share(0.5), 0.5, 0.02);
  EXPECT_LT(learning_rate_share(1), 0.01);
  EXPECT_GT(learning_rate_share(1), 0);
}

TEST(Schedule, CountsStepsWhereTheyAreGiven) {
  const Schedule schedule(10, 1e9);
  EXPECT_EQ(schedule.share(0), 0.0);
  EXPECT_EQ(schedule.share(5), 0.5);
  EXPECT_EQ(schedule.share(10), 1.0);
}

TEST(Schedule, GoesOnFromAShare) {
  Schedule schedule(std::nullopt, 1e6);
  schedule.go_on_from(0.75);
  EXPECT_NEAR(schedule.share(0), 0.75, 1e-3);
  EXPECT_NEAR(schedule.seconds_left(0), 0.25e6, 1);
  schedule.go_on_from(1.0);
  EXPECT_GE(schedule.share(0), 1.0);
}

TEST(Schedule, EndsAtAMomentThatLeavesTimeForWhatFollows) {
  Time now = time_from_ns(0);
  const auto clock = [&now] { return now; };
  Schedule schedule(now + std::chrono::hours(1), 0.75, 0.25, clock);
  EXPECT_NEAR(schedule.seconds_left(0), 0.75 * 3600, 1);
  // A break of half an hour: what is left is shared anew.
  now += std::chrono::minutes(30);
  schedule.go_on_from(0.5);
  EXPECT_NEAR(schedule.share(0), 0.5, 1e-3);
  EXPECT_NEAR(schedule.seconds_left(0), 1800 * 0.375 / (0.375 + 0.25), 1);
  now += std::chrono::minutes(31);
  schedule.go_on_from(0.5);
  EXPECT_GE(schedule.share(0), 1.0);
}

TEST(ErrorPrice, FollowsTheQualityInBothDirections) {
  ErrorPrice price(36);
  const double first = price.value();
  price.follow(20, 0.04);  // Too early.
  EXPECT_DOUBLE_EQ(price.value(), first);
  for (double share = 0.05; share < 0.2; share += 0.01) price.follow(28, share);
  const double raised = price.value();
  EXPECT_GT(raised, 2 * first);
  for (double share = 0.2; share < 0.5; share += 0.01) price.follow(39, share);
  EXPECT_LT(price.value(), raised / 2);
  EXPECT_GT(price.value(), 0);
}

TEST(ErrorPrice, ExpectsWhatTrainingGainsByItself) {
  ErrorPrice price(36);
  const double first = price.value();
  // Half of the time is over: 1.7 dB are to come.
  price.follow(34.3, 0.5);
  EXPECT_NEAR(price.value(), first, 1e-9);
  ErrorPrice behind(36), ahead(36);
  for (double share = 0.5; share < 0.6; share += 0.01) {
    behind.follow(33, share);
    ahead.follow(35.5, share);
  }
  EXPECT_GT(behind.value(), first);
  EXPECT_LT(ahead.value(), first);
}

TEST(ErrorPrice, StaysAtTheEndWhereTheQualityIsWhatWasAskedFor) {
  ErrorPrice price(36);
  price.follow(36, 1);
  const double last = price.value();
  price.follow(36, 1);
  EXPECT_DOUBLE_EQ(price.value(), last);
}

TEST(Smoothed, StartsWithItsFirstValue) {
  Smoothed mean(0.1);
  mean.add(5);
  EXPECT_EQ(mean.value(), 5.0);
  mean.add(15);
  EXPECT_DOUBLE_EQ(mean.value(), 6.0);
}

}  // namespace
}  // namespace engram::training
