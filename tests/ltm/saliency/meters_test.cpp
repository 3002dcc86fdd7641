// SPDX-License-Identifier: Apache-2.0
// Surprise and novelty.
#include <cmath>
#include <random>

#include "ltm/saliency/novelty_meter.h"
#include "ltm/saliency/saliency.h"
#include "ltm/saliency/surprise_meter.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/saliency/drawn_series.h"

namespace engram::ltm {
namespace {

std::vector<Surprise> surprises_of(const ContentSeries& series) {
  SurpriseMeter meter;
  std::vector<Surprise> found;
  for (size_t i = 0; i < series.size(); ++i) found.push_back(meter.next(series, i));
  return found;
}

TEST(SurpriseMeter, ALineIsContinuedAndItsBendIsASurprise) {
  std::vector<float> line;
  for (int i = 0; i < 100; ++i) line.push_back(i < 60 ? 0.1f * static_cast<float>(i) : 6.0f);
  const auto found = surprises_of(drawn_series(line));
  EXPECT_FALSE(found[5].is_known);
  EXPECT_EQ(found[5].part(), 0);
  EXPECT_TRUE(found[50].is_line);
  EXPECT_LT(found[50].part(), 0.1);
  EXPECT_GT(found[61].ratio(), 10);
  EXPECT_NEAR(found[61].predicted, 6.1, 1e-4);
  EXPECT_LT(found[99].part(), 0.1);
}

TEST(SurpriseMeter, NoiseIsWithinItsBoundNineTimesInTen) {
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  std::vector<float> noise;
  for (int i = 0; i < 3000; ++i) noise.push_back(normal(random));
  int beyond = 0;
  double sum = 0;
  for (const Surprise& one : surprises_of(drawn_series(noise))) {
    beyond += one.is_known && one.ratio() > 1 ? 1 : 0;
    sum += one.part();
  }
  EXPECT_NEAR(beyond, 300, 90);
  EXPECT_LT(sum / 3000, 0.02);  // And barely beyond it.
}

TEST(SurpriseMeter, WhatItSaysDependsOnTheSnapshotsInItsReachAlone) {
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  std::vector<float> noise;
  for (int i = 0; i < 200; ++i) noise.push_back(normal(random));
  const auto all = surprises_of(drawn_series(noise));
  const std::vector<float> tail(noise.end() - 1 - SurpriseMeter::kReach, noise.end());
  const auto late = surprises_of(drawn_series(tail));
  EXPECT_EQ(late.back().ratio(), all.back().ratio());
  EXPECT_EQ(late.back().is_line, all.back().is_line);
}

TEST(SurpriseMeter, ATextThatSeldomChangesIsASurprise) {
  ContentSeries series = drawn_series(std::vector<float>(80, 0));
  series.facts[60] = 2;  // And back at 61.
  const auto found = surprises_of(series);
  EXPECT_EQ(found[60].part(), 1);
  EXPECT_LT(found[61].part(), 1);
  EXPECT_EQ(found[70].part(), 0);
}

TEST(NoveltyMeter, WhatComesBackIsNotNew) {
  std::vector<float> numbers;
  for (int i = 0; i < 600; ++i) numbers.push_back(std::sin(0.05f * static_cast<float>(i)));
  numbers.push_back(3);
  const ContentSeries series = drawn_series(numbers);
  NoveltyMeter meter(series.members);
  std::vector<double> found;
  for (size_t i = 0; i < series.size(); ++i) found.push_back(meter.next(series, i));
  EXPECT_EQ(found[0], 1);
  EXPECT_LT(*std::max_element(found.begin() + 200, found.begin() + 600), 0.05);
  EXPECT_EQ(found[600], 1);
}

TEST(NoveltyMeter, TenThousandPlacesStayWithinItsExamples) {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> uniform(0, 10);
  std::vector<float> numbers;
  for (int i = 0; i < 10'000; ++i) numbers.push_back(uniform(random));
  const ContentSeries series = drawn_series(numbers);
  NoveltyMeter meter(series.members);
  double last = 0;
  for (size_t i = 0; i < series.size(); ++i) {
    const double found = meter.next(series, i);
    if (i > 5000) last = std::max(last, found);
  }
  EXPECT_LT(last, 0.2);  // 256 examples cover ten units.
}

TEST(NoveltyMeter, WordsThatCameBeforeAreLessNew) {
  ContentSeries series = drawn_series(std::vector<float>(10, 0));
  series.facts = {1, 2, 1, 1, 3, 1, 1, 1, 1, 1};
  NoveltyMeter meter(series.members);
  std::vector<double> found;
  for (size_t i = 0; i < series.size(); ++i) found.push_back(meter.next(series, i));
  EXPECT_EQ(found[1], 1);
  EXPECT_EQ(found[2], 0.5);
  EXPECT_EQ(found[4], 1);
  EXPECT_NEAR(found[9], 1.0 / 8, 1e-9);
}

TEST(Saliency, IsTheWeightedSumOfItsParts) {
  const SaliencyWeights weights = SaliencyWeights::standard();
  ASSERT_OK(weights.validate());
  SaliencyParts parts;
  EXPECT_EQ(saliency_of(parts, weights), 0);
  double sum = 0;
  for (size_t i = 0; i < kSaliencyParts; ++i) {
    const auto part = static_cast<SaliencyPart>(i);
    parts[part] = 1;
    sum += weights.parts[part];
    EXPECT_NEAR(saliency_of(parts, weights), sum, 1e-12) << name_of(part);
  }
  EXPECT_NEAR(sum, 1, 1e-12);
  SaliencyWeights wrong = weights;
  wrong.parts[SaliencyPart::kSpeech] = 0.9;
  EXPECT_EQ(wrong.validate().code(), StatusCode::kInvalidArgument);
  wrong.parts[SaliencyPart::kSpeech] = -0.1;
  EXPECT_EQ(wrong.validate().code(), StatusCode::kInvalidArgument);
}

TEST(Saliency, PartsGrowFromNothingToOne) {
  EXPECT_EQ(change_part(0), 0);
  EXPECT_EQ(change_part(0.01), 0);
  EXPECT_NEAR(change_part(1), 0.5, 1e-9);
  EXPECT_EQ(change_part(500), 1);
  for (const double seconds : {0.02, 0.5, 70.0})
    EXPECT_NEAR(change_seconds(change_part(seconds)), seconds, 1e-9);
  EXPECT_EQ(surprise_part(1), 0);
  EXPECT_NEAR(surprise_part(10), 0.5, 1e-9);
  EXPECT_EQ(surprise_part(1e6), 1);
  EXPECT_EQ(reads_part(0), 0);
  EXPECT_EQ(reads_part(1), 0.5);
}

}  // namespace
}  // namespace engram::ltm
