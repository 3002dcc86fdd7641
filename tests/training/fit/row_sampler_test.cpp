// SPDX-License-Identifier: Apache-2.0
#include "training/fit/row_sampler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace engram::training {
namespace {

constexpr int64_t kDraws = 20000;

/// Two recordings; the last row of each is held out.
RowSampler make_sampler() {
  const std::vector<Sequence> sequences{{0, 6}, {6, 10}};
  const std::vector<size_t> first_held_out{5, 9};
  return {sequences, first_held_out};
}

TEST(RowSampler, DrawsEveryRowAsOftenWhereAllCostTheSame) {
  RowSampler sampler = make_sampler();
  std::map<int64_t, int> counts;
  for (int64_t i = 0; i < kDraws; ++i)
    for (const auto& [last, weight] : sampler.draw(1)) {
      ++counts[last];
      EXPECT_DOUBLE_EQ(weight, 1.0);
    }
  ASSERT_EQ(counts.size(), 10U);
  for (const auto& [row, count] : counts) EXPECT_NEAR(count, kDraws / 10, 200) << row;
}

TEST(RowSampler, DrawsCostlyRowsMoreOftenAndKeepsTheMean) {
  RowSampler sampler = make_sampler();
  for (int64_t row = 0; row < 10; ++row) sampler.told(row, row == 3 ? 9.0 : 1.0);
  std::map<int64_t, int> counts;
  std::map<int64_t, double> weights;
  for (int64_t i = 0; i < kDraws; ++i)
    for (const auto& [last, weight] : sampler.draw(2)) {
      ++counts[last];
      weights[last] += weight;
    }
  // Half of the draws go to all alike, half by cost: 0.05 + 0.5 * 9 / 18.
  EXPECT_NEAR(counts[3], 2 * kDraws * 0.3, 500);
  for (const auto& [row, weight] : weights) EXPECT_NEAR(weight, 2 * kDraws / 10.0, 350) << row;
}

TEST(RowSampler, NeverMixesHeldOutRowsWithOthers) {
  RowSampler sampler = make_sampler();
  int held_out = 0;
  for (int64_t i = 0; i < 2000; ++i) {
    const auto draws = sampler.draw(3);
    for (const auto& draw : draws)
      EXPECT_EQ(sampler.is_held_out(draw.last), sampler.is_held_out(draws.front().last));
    held_out += sampler.is_held_out(draws.front().last);
  }
  EXPECT_NEAR(held_out, 400, 80);
}

TEST(RowSampler, DrawsWhatIsKnownInAThirdOfTheDrawsAtMost) {
  const std::vector<Sequence> sequences{{0, 8}, {8, 10}};
  const std::vector<size_t> first_held_out{8, 10};
  std::vector<bool> is_known(10, false);
  std::fill_n(is_known.begin(), 8, true);
  RowSampler sampler(sequences, first_held_out, is_known);
  for (int64_t row = 0; row < 10; ++row) sampler.told(row, row == 3 ? 5.0 : 1.0);
  int known = 0;
  double known_weight = 0, weight = 0;
  for (int64_t i = 0; i < kDraws; ++i) {
    const auto draw = sampler.draw(1).front();
    weight += draw.weight;
    if (draw.last >= 8) continue;
    ++known;
    known_weight += draw.weight;
  }
  // By cost, row 3 counts five times of eight: 0.5 * 0.3 + 0.5 * (0.3 / 8 * 12) / (that + 0.7).
  EXPECT_NEAR(known, kDraws * (0.15 + 0.5 * 0.45 / 1.15), 300);
  EXPECT_NEAR(known_weight, kDraws * 0.3, 300);
  EXPECT_NEAR(weight, kDraws, 300);
}

TEST(RowSampler, DrawsAllAlikeWhereFewOrAllAreKnown) {
  const std::vector<Sequence> sequences{{0, 10}};
  const std::vector<size_t> first_held_out{10};
  for (const int64_t count : {2, 10}) {
    std::vector<bool> is_known(10, false);
    std::fill_n(is_known.begin(), count, true);
    RowSampler sampler(sequences, first_held_out, is_known);
    std::map<int64_t, int> counts;
    for (int64_t i = 0; i < kDraws; ++i) ++counts[sampler.draw(1).front().last];
    for (const auto& [row, drawn] : counts) EXPECT_NEAR(drawn, kDraws / 10, 200) << row;
  }
}

TEST(RowSampler, KnowsWhereASequenceBegins) {
  const RowSampler sampler = make_sampler();
  EXPECT_EQ(sampler.first_of(5), 0);
  EXPECT_EQ(sampler.first_of(6), 6);
  EXPECT_TRUE(sampler.is_held_out(9));
  EXPECT_FALSE(sampler.is_held_out(8));
}

}  // namespace
}  // namespace engram::training
