// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/prefix_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "ltm/recall/entity_arrivals.h"

namespace engram::ltm {
namespace {

std::vector<uint32_t> permutation_of(size_t size, std::mt19937& random) {
  std::vector<uint32_t> entries(size);
  std::iota(entries.begin(), entries.end(), 0);
  std::ranges::shuffle(entries, random);
  return entries;
}

TEST(PrefixOrder, OrdersTheFirstEntriesHoweverMany) {
  std::mt19937 random(4);
  for (const size_t size : {1, 2, 3, 7, 8, 63, 64, 65, 500, 512, 513, 1300}) {
    const std::vector<uint32_t> entries = permutation_of(size, random);
    const PrefixOrder order(entries);
    for (const size_t count : {size_t{1}, size / 3, size / 2, size - 1, size}) {
      std::vector<uint32_t> sorted(entries.begin(), entries.begin() + static_cast<int64_t>(count));
      std::ranges::sort(sorted);
      for (size_t i = 0; i < count; ++i) ASSERT_EQ(order.nth(count, i), sorted[i]) << size;
      for (size_t bound = 0; bound <= size + 1; ++bound) {
        const auto found = std::ranges::lower_bound(sorted, bound) - sorted.begin();
        ASSERT_EQ(order.below(count, bound), static_cast<size_t>(found)) << size << " " << bound;
      }
    }
  }
}

TEST(PrefixOrder, HasNothingOfNoEntries) {
  EXPECT_EQ(PrefixOrder().below(0, 5), 0u);
  EXPECT_EQ(PrefixOrder(std::vector<uint32_t>{3, 0, 2, 1}).below(0, 2), 0u);
  EXPECT_DEATH((void)PrefixOrder().nth(0, 0), "entry 0 of 0");
}

/// Some of every millisecond, and all of one.
TEST(EntityArrivals, TellsWhatHadArrivedAtAnyMoment) {
  std::mt19937 random(8);
  const auto at = [](int64_t ms) { return Time(std::chrono::milliseconds(ms)); };
  for (int round = 0; round < 60; ++round) {
    std::vector<Time> times, arrived;
    for (int64_t i = 0; i < 100; ++i) {
      times.push_back(at(3 * i));
      const int64_t late = round % 3 == 0 ? 5 : static_cast<int64_t>(random() % 90);
      arrived.push_back(round % 3 == 1 ? at(late) : at(3 * i + late));
    }
    const EntityArrivals arrivals(times, arrived);
    for (int64_t now = -1; now < 400; now += 7) {
      std::vector<Time> there;
      for (size_t i = 0; i < times.size(); ++i)
        if (arrived[i] <= at(now)) there.push_back(times[i]);
      const size_t count = arrivals.arrived_until(at(now));
      ASSERT_EQ(arrivals.times(count), there);
      for (size_t i = 0; i < count; ++i) ASSERT_EQ(arrivals.nth_time(i, count), there[i]);
      for (int64_t time = -1; time < 310; ++time) {
        const auto first = std::ranges::lower_bound(there, at(time));
        ASSERT_EQ(arrivals.before(at(time), count), static_cast<size_t>(first - there.begin()));
      }
    }
  }
}

}  // namespace
}  // namespace engram::ltm
