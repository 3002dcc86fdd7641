// SPDX-License-Identifier: Apache-2.0
#include "training/fit/sequences.h"

#include <gtest/gtest.h>

namespace engram::training {
namespace {

std::vector<Time> at_ms(std::initializer_list<int> milliseconds) {
  std::vector<Time> times;
  for (const int ms : milliseconds) times.push_back(time_from_ns(int64_t{ms} * 1'000'000));
  return times;
}

TEST(Sequences, CutWhereAGapIsLongerThanOneAndAHalfSteps) {
  const auto sequences = cut_sequences(at_ms({0, 100, 200, 350, 450, 601, 701}));
  EXPECT_EQ(sequences, (std::vector<Sequence>{{0, 5}, {5, 7}}));
}

TEST(Sequences, AreOneWhereTimesAreEven) {
  EXPECT_EQ(cut_sequences(at_ms({5, 10, 15})), (std::vector<Sequence>{{0, 3}}));
}

TEST(Sequences, KeepASingleSnapshot) {
  EXPECT_EQ(cut_sequences(at_ms({5})), (std::vector<Sequence>{{0, 1}}));
  EXPECT_TRUE(cut_sequences({}).empty());
}

TEST(Sequences, AreCutWhereTimeGoesBack) {
  EXPECT_EQ(cut_sequences(at_ms({0, 200, 400, 33, 233})), (std::vector<Sequence>{{0, 3}, {3, 5}}));
}

TEST(Sequences, AreTakenApartIntoSlowerOnes) {
  const auto times = at_ms({1000, 5000, 5033, 5067, 5100, 5133, 5167});
  EXPECT_EQ(interleaved(times, {1, 7}, std::chrono::milliseconds(100)),
            (std::vector<std::vector<size_t>>{{1, 4}, {2, 5}, {3, 6}}));
}

TEST(Sequences, StayWholeWhereTheyAreSlowAlready) {
  const auto times = at_ms({0, 100, 200, 300});
  EXPECT_EQ(interleaved(times, {0, 4}, std::chrono::milliseconds(100)),
            (std::vector<std::vector<size_t>>{{0, 1, 2, 3}}));
  EXPECT_EQ(interleaved(times, {0, 4}, std::chrono::milliseconds(50)),
            (std::vector<std::vector<size_t>>{{0, 1, 2, 3}}));
}

TEST(Sequences, KnowTheMedianStep) {
  EXPECT_EQ(median_step(at_ms({0, 100, 200, 900})), std::chrono::milliseconds(100));
  EXPECT_EQ(median_step(at_ms({3})), Duration::zero());
}

}  // namespace
}  // namespace engram::training
