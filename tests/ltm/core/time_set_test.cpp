// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/time_set.h"

#include <gmock/gmock.h>

#include <random>
#include <set>

namespace engram {
namespace {

Time at(int64_t ns) {
  return time_from_ns(ns);
}

TEST(TimeSet, IsWhatASetIs) {
  std::mt19937 random(3);
  std::set<Time> expected;
  TimeSet found;
  for (int i = 0; i < 500; ++i) {
    const Time time = at(static_cast<int64_t>(random() % 200));
    EXPECT_EQ(found.insert(time), expected.insert(time).second);
  }
  EXPECT_TRUE(std::ranges::equal(found, expected));
  for (int64_t ns = -1; ns < 201; ++ns)
    EXPECT_EQ(found.contains(at(ns)), expected.contains(at(ns))) << ns;
}

TEST(TimeSet, TakesTimesInAnyOrder) {
  EXPECT_THAT(TimeSet({at(3), at(1), at(3), at(2)}), testing::ElementsAre(at(1), at(2), at(3)));
}

TEST(TimeSet, JoinsAnother) {
  TimeSet times{at(1), at(5)};
  times.insert_all({at(0), at(5), at(9)});
  EXPECT_EQ(times, TimeSet({at(0), at(1), at(5), at(9)}));
  EXPECT_EQ(times.front(), at(0));
  EXPECT_EQ(times.back(), at(9));
}

TEST(TimeSet, TellsWhetherASpanHoldsAny) {
  const TimeSet times{at(2), at(7)};
  EXPECT_TRUE(times.has_any_in(at(2), at(2)));
  EXPECT_TRUE(times.has_any_in(at(3), at(7)));
  EXPECT_FALSE(times.has_any_in(at(3), at(6)));
  EXPECT_FALSE(times.has_any_in(at(8), at(100)));
  EXPECT_FALSE(TimeSet().has_any_in(Time::min(), Time::max()));
}

}  // namespace
}  // namespace engram
