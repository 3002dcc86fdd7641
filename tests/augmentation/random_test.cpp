// SPDX-License-Identifier: Apache-2.0
#include "augmentation/random.h"

#include <gtest/gtest.h>

#include <array>

namespace engram::augmentation {
namespace {

TEST(Random, IsThePublishedSequence) {
  // The first numbers of splitmix64 from seed 1234567.
  Random random(1234567);
  EXPECT_EQ(random.next(), 6457827717110365317u);
  EXPECT_EQ(random.next(), 3203168211198807973u);
  EXPECT_EQ(random_at(1234567, 1), 3203168211198807973u);
}

TEST(Random, StaysWithinItsEndsAndReachesThem) {
  Random random(7);
  std::array<int, 5> seen{};
  for (int i = 0; i < 1000; ++i) ++seen.at(static_cast<size_t>(random.between(-2, 2) + 2));
  for (const int count : seen) EXPECT_NEAR(count, 200, 60);
  EXPECT_EQ(random.between(4, 4), 4);
  EXPECT_GE(random.between(0, int64_t{1} << 48), 0);
}

}  // namespace
}  // namespace engram::augmentation
