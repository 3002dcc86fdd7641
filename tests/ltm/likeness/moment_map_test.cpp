// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/moment_map.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "ltm/likeness/coded_moments.h"

namespace engram::ltm {
namespace {

/// Numbers of which two directions vary much, and all others little.
CodedMoments flat_moments(size_t count, size_t numbers) {
  std::mt19937 random(3);
  std::normal_distribution<float> noise(0, 0.01F);
  CodedMoments coded;
  coded.coded_by = CodedBy::kNumbers;
  coded.numbers = numbers;
  for (size_t i = 0; i < count; ++i) {
    coded.times.push_back(time_from_ns(static_cast<int64_t>(i) * 200'000'000));
    const float u = std::exp(noise(random) * 100);
    const float v = static_cast<float>(i % 7) / 7;
    for (size_t k = 0; k < numbers; ++k)
      coded.floats.push_back(5 + (k % 2 == 0 ? u : v) + noise(random));
  }
  coded.finish();
  return coded;
}

TEST(MomentMap, HasTheTwoDirectionsOfTheLargestVariance) {
  for (const size_t numbers : {4U, 48U, 1'500U}) {
    const CodedMoments coded = flat_moments(900, numbers);
    const MomentMap map = map_of(coded, 300);
    EXPECT_EQ(map.space, "numbers");
    EXPECT_EQ(map.known, 900u);
    ASSERT_EQ(map.times.size(), 300u);
    EXPECT_EQ(map.times[1], coded.times[3]);
    EXPECT_GT(map.explained, 0.99) << numbers;
    EXPECT_LE(map.explained, 1.0001);
    // Distances in the map are those of the codes, in their unit.
    for (const size_t i : {0u, 17u, 299u}) {
      const auto squares = coded.square_distances(3 * i, Duration::zero());
      for (size_t j = 0; j < 300; ++j)
        ASSERT_NEAR(std::hypot(map.x[i] - map.x[j], map.y[i] - map.y[j]), std::sqrt(squares[3 * j]),
                    0.05)
            << i << " and " << j;
    }
  }
}

TEST(MomentMap, StaysAsItWasWhenMomentsAreAdded) {
  const CodedMoments whole = flat_moments(900, 48);
  CodedMoments some = whole;
  some.truncate(800);
  some.finish_from(800);
  const MomentMap before = map_of(some, 10'000);
  const MomentMap after = map_of(whole, 10'000);
  ASSERT_EQ(before.x.size(), 800u);
  for (size_t i = 0; i < 800; ++i) EXPECT_NEAR(before.x[i], after.x[i], 0.3) << i;
}

TEST(MomentMap, IsOnePlaceWhereNothingVaries) {
  CodedMoments coded;
  coded.coded_by = CodedBy::kNumbers;
  coded.numbers = 3;
  EXPECT_TRUE(map_of(coded, 10).times.empty());
  for (int i = 0; i < 5; ++i) {
    coded.times.push_back(time_from_ns(i * 1'000'000'000));
    coded.floats.insert(coded.floats.end(), {1, 2, 3});
  }
  coded.finish();
  const MomentMap map = map_of(coded, 10);
  EXPECT_EQ(map.x, std::vector<float>(5));
  EXPECT_EQ(map.y, std::vector<float>(5));
  EXPECT_EQ(map.explained, 0);
  EXPECT_EQ(map_of(coded, 1).times.size(), 1u);
}

}  // namespace
}  // namespace engram::ltm
