// SPDX-License-Identifier: Apache-2.0
#include "training/fit/conformal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "ltm/memory/result.h"

namespace engram::training {
namespace {

/// Errors in proportion to what changed, calm and busy moments in turn by chance.
std::vector<MeasuredPrediction> draw(std::mt19937_64& random, size_t count) {
  std::vector<MeasuredPrediction> drawn;
  std::normal_distribution<double> noise(0, 0.7);
  std::bernoulli_distribution is_busy(0.5);
  for (size_t i = 0; i < count; ++i) {
    const double change = (is_busy(random) ? 400.0 : 10.0) * std::exp(0.2 * noise(random));
    drawn.push_back({change, 2 * change * std::exp(noise(random))});
  }
  return drawn;
}

TEST(ConformalQuantile, IsTheScoreOfTheRankThatTheTheoremAsksFor) {
  std::vector<double> scores(19);
  std::iota(scores.rbegin(), scores.rend(), 1.0);
  EXPECT_EQ(conformal_quantile(scores, 0.9), 18);  // ceil(20 * 0.9)
  EXPECT_EQ(conformal_quantile(scores, 0.5), 10);  // ceil(20 * 0.5)
  EXPECT_EQ(conformal_quantile(scores, 0.01), 1);
}

TEST(ConformalQuantile, GrowsWithTheProbability) {
  std::mt19937_64 random(3);
  std::vector<double> scores(50);
  for (double& score : scores) score = std::exponential_distribution<double>(1)(random);
  double last = 0;
  for (double probability = 0.05; probability < 0.98; probability += 0.05) {
    const double now = conformal_quantile(scores, probability);
    EXPECT_GE(now, last) << probability;
    last = now;
  }
  EXPECT_GT(last, conformal_quantile(scores, 0.05));
}

TEST(ConformalQuantile, IsNotKnownOfTooFewScores) {
  EXPECT_TRUE(std::isnan(conformal_quantile({}, 0.9)));
  EXPECT_TRUE(std::isnan(conformal_quantile(std::vector<double>(8, 1.0), 0.9)));
  EXPECT_EQ(conformal_quantile(std::vector<double>(9, 1.0), 0.9), 1.0);
  EXPECT_TRUE(std::isnan(conformal_quantile(std::vector<double>(98, 1.0), 0.99)));
  EXPECT_EQ(conformal_quantile(std::vector<double>(99, 1.0), 0.99), 1.0);
}

TEST(Calibrate, CoversWhatComesNextAsOftenAsItSays) {
  std::mt19937_64 random(1);
  constexpr int kTrials = 400;
  constexpr size_t kNew = 200;
  double within = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto by = calibrate(draw(random, 20), draw(random, 20), 1);
    for (const MeasuredPrediction& one : draw(random, kNew))
      within += one.error <= by.bound(one.change) ? 1 : 0;
  }
  // Of 20 scores the 19th: 19 / 21 of what comes next.
  EXPECT_NEAR(within / (kTrials * kNew), 19.0 / 21.0, 0.01);
}

TEST(Calibrate, IsNarrowInCalmAndWideInBusyMoments) {
  std::mt19937_64 random(2);
  const auto by = calibrate(draw(random, 200), draw(random, 200), 1);
  EXPECT_GE(by.exponent, 0.75);
  EXPECT_LT(10 * by.bound(10), by.bound(400));
  EXPECT_LT(10 * by.expected(10), by.expected(400));
  EXPECT_LT(by.expected(10), by.bound(10));
  // Within in both, where one bound for all would hold of nearly all calm ones.
  double calm = 0, calm_within = 0, busy = 0, busy_within = 0;
  for (const MeasuredPrediction& one : draw(random, 4000)) {
    const double is_within = one.error <= by.bound(one.change) ? 1 : 0;
    (one.change < 60 ? calm : busy) += 1;
    (one.change < 60 ? calm_within : busy_within) += is_within;
  }
  EXPECT_NEAR(calm_within / calm, ltm::kBoundProbability, 0.05);
  EXPECT_NEAR(busy_within / busy, ltm::kBoundProbability, 0.05);
}

TEST(Calibrate, DoesNotScaleWhatDoesNotFollowTheChange) {
  std::mt19937_64 random(4);
  auto choosing = draw(random, 100), calibrating = draw(random, 100);
  std::lognormal_distribution<double> error(2, 0.3);
  for (auto* all : {&choosing, &calibrating})
    for (MeasuredPrediction& one : *all) one.error = error(random);
  const auto by = calibrate(choosing, calibrating, 1);
  EXPECT_EQ(by.exponent, 0);
  EXPECT_EQ(by.bound(10), by.bound(400));
}

TEST(Calibrate, ExpectsTheMeanErrorOnAverage) {
  std::mt19937_64 random(5);
  const auto calibrating = draw(random, 60);
  const auto by = calibrate(draw(random, 60), calibrating, 1);
  double expected = 0, real = 0;
  for (const MeasuredPrediction& one : calibrating) {
    expected += by.expected(one.change);
    real += one.error;
  }
  EXPECT_NEAR(expected, real, 1e-9 * real);
  EXPECT_NEAR(by.mean, real / 60, 1e-9 * real);
  EXPECT_EQ(by.measured, 60);
}

TEST(Calibrate, TellsNoBoundOfTooFew) {
  std::mt19937_64 random(6);
  const auto few = calibrate(draw(random, 9), draw(random, 8), 1);
  EXPECT_TRUE(std::isnan(few.bound(10)));
  EXPECT_GT(few.expected(10), 0);
  const auto half = calibrate(draw(random, 5), {}, 1);
  EXPECT_TRUE(std::isnan(half.bound(10)));
  EXPECT_EQ(half.exponent, 0);
  EXPECT_EQ(half.expected(10), half.mean);
  const auto none = calibrate({}, {}, 1);
  EXPECT_TRUE(std::isnan(none.bound(10)));
  EXPECT_TRUE(std::isnan(none.expected(10)));
  EXPECT_TRUE(none.validate().ok());
}

TEST(Calibrate, ExpectsTheUsualWhereNothingIsKnownOfTheChange) {
  std::mt19937_64 random(7);
  const auto by = calibrate(draw(random, 30), draw(random, 30), 1);
  EXPECT_EQ(by.expected(std::nan("")), by.mean);
  EXPECT_TRUE(std::isnan(by.bound(std::nan(""))));
}

TEST(Calibrate, BearsPerfectPredictions) {
  const std::vector<MeasuredPrediction> perfect(12, {0.0, 0.0});
  const auto by = calibrate(perfect, perfect, 1e-6);
  EXPECT_EQ(by.bound(0), 0);
  EXPECT_EQ(by.expected(100), 0);
  EXPECT_TRUE(by.validate().ok());
}

TEST(Widen, MakesUpForCalmWindows) {
  std::vector<MeasuredPrediction> own, calm, all;
  for (int i = 1; i <= 40; ++i) {
    const double x = i;
    own.push_back({1, x});
    calm.push_back({1, 2 * x});
    all.push_back({1, (i % 2 == 0 ? 2 : 6) * x});
  }
  const encoders::ErrorCalibration narrow = calibrate({}, own, 1);
  encoders::ErrorCalibration by = narrow;
  widen(by, all, calm);
  // The 37th of 40: 74 where it is calm; 198 of all.
  EXPECT_NEAR(by.bound(1), narrow.bound(1) * 198 / 74, 1e-9);
  EXPECT_NEAR(by.expected(1), narrow.expected(1) * 1.9756097561, 1e-6);
  // Never narrower, and nothing changes where little is known.
  for (const size_t known : {size_t{40}, size_t{5}}) {
    encoders::ErrorCalibration same = narrow;
    widen(same, std::span(calm).first(known), known == 40 ? std::span(all) : std::span(calm));
    EXPECT_DOUBLE_EQ(same.bound(1), narrow.bound(1)) << known;
  }
}

}  // namespace
}  // namespace engram::training
