// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/sequences.h"

#include <gtest/gtest.h>

namespace engram {
namespace {

std::vector<Time> at_ms(std::initializer_list<int> steps_ms) {
  std::vector<Time> times;
  for (const int ms : steps_ms) times.push_back(time_from_ns(int64_t{ms} * 1'000'000));
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

TEST(Recordings, EndAtGapsThatAreUnusualForTheirFilter) {
  // Movement is kept at 5 Hz, rest as it comes: up to 0.8 s, which one step in ten takes.
  std::vector<int64_t> steps;
  for (int i = 0; i < 60; ++i) steps.push_back(i % 6 == 5 ? 800 : 200);
  steps.push_back(60'000);
  for (int i = 0; i < 60; ++i) steps.push_back(i % 6 == 5 ? 800 : 200);
  std::vector<Time> times{time_from_ns(0)};
  for (const int64_t ms : steps) times.push_back(times.back() + std::chrono::milliseconds(ms));
  EXPECT_EQ(cut_recordings(times), (std::vector<Sequence>{{0, 61}, {61, 122}}));
  EXPECT_GT(cut_sequences(times).size(), 20);  // Steps of networks are even.
}

TEST(Recordings, AreCutAsBeforeWhenALittleIsAdded) {
  std::vector<Time> times{time_from_ns(0)};
  for (int i = 0; i < 300; ++i)
    times.push_back(times.back() + std::chrono::milliseconds(i % 50 == 49 ? 1'200 : 200));
  const auto before = cut_recordings(times);
  for (int i = 0; i < 40; ++i)
    times.push_back(times.back() + std::chrono::milliseconds(i % 2 == 1 ? 210 : 190));
  const auto after = cut_recordings(times);
  ASSERT_EQ(after.size(), before.size());
  for (size_t i = 0; i + 1 < before.size(); ++i) EXPECT_EQ(after[i], before[i]);
}

TEST(Recordings, StayWholeWhereEachIsShort) {
  // Five images a minute apart from the next five: coded together they need one key image.
  std::vector<Time> times;
  for (int i = 0; i < 50; ++i)
    times.push_back(time_from_ns((int64_t{i / 5} * 60'000 + i % 5 * 200) * 1'000'000));
  EXPECT_EQ(cut_recordings(times).size(), 1);
  EXPECT_EQ(cut_recordings({}).size(), 0);
  EXPECT_EQ(cut_recordings(std::span(times).first(1)), (std::vector<Sequence>{{0, 1}}));
}

TEST(Recordings, EndWhereTimesAreCenturiesApart) {
  const std::vector<Time> times{time_from_ns(0), time_from_ns(INT64_MAX - 1),
                                time_from_ns(INT64_MAX)};
  EXPECT_EQ(cut_recordings(times), (std::vector<Sequence>{{0, 1}, {1, 3}}));
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
}  // namespace engram
