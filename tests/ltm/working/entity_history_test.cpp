// SPDX-License-Identifier: Apache-2.0
#include "ltm/working/entity_history.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace engram::ltm {
namespace {

EntityHistory::Entry entry(int64_t at) {
  return {hold_untyped({*MemoryId::parse("A/b/c/d"), time_from_ns(at), {{at, {}}}}), Time(), 8};
}

std::vector<int64_t> times(const EntityHistory& history) {
  std::vector<int64_t> all;
  for (size_t i = 0; i < history.size(); ++i) all.push_back(to_ns(history[i].time));
  return all;
}

TEST(EntityHistory, OrdersWhatComesLate) {
  EntityHistory history;
  for (const int64_t at : {10, 30, 20, 5}) EXPECT_FALSE(history.put(entry(at)).replaced);
  EXPECT_EQ(times(history), (std::vector<int64_t>{5, 10, 20, 30}));
  EXPECT_EQ(history.find(time_from_ns(20)), 2u);
  EXPECT_FALSE(history.find(time_from_ns(21)));
  EXPECT_EQ(history.lower_bound(time_from_ns(21)), 3u);
  EXPECT_EQ(history.lower_bound(time_from_ns(31)), 4u);
}

TEST(EntityHistory, FindsTimesAtAnyIntervals) {
  std::vector<std::vector<int64_t>> series{{7}, {7, 8}, {INT64_MIN, 0, INT64_MAX}};
  std::minstd_rand random(1);
  for (const double power : {0.2, 1.0, 5.0, 20.0}) {
    auto& times = series.emplace_back();
    for (int i = 0; i < 300; ++i)
      times.push_back(static_cast<int64_t>(1e15 * std::pow(i / 300.0, power)) + i);
  }
  auto& any = series.emplace_back();
  for (int i = 0; i < 300; ++i) any.push_back(static_cast<int64_t>(random() % 1000));
  for (auto& times : series) {
    EntityHistory history;
    for (const int64_t at : times) history.put(entry(at));
    std::ranges::sort(times);
    times.erase(std::unique(times.begin(), times.end()), times.end());
    for (const int64_t at : times)
      for (const int64_t asked : {at, at == INT64_MIN ? at : at - 1, at == INT64_MAX ? at : at + 1})
        EXPECT_EQ(history.lower_bound(time_from_ns(asked)),
                  static_cast<size_t>(std::ranges::lower_bound(times, asked) - times.begin()))
            << asked << " in " << times.size();
  }
}

TEST(EntityHistory, GivesBackWhatHadTheSameTime) {
  EntityHistory history;
  const auto first = entry(10);
  history.put(first);
  const auto placed = history.put(entry(10));
  ASSERT_TRUE(placed.replaced);
  EXPECT_EQ(placed.replaced->snapshot, first.snapshot);
  EXPECT_EQ(history.size(), 1u);
}

TEST(EntityHistory, ChoosesTheOldestFirst) {
  EntityHistory history;
  for (const int64_t at : {10, 20, 30}) history.put(entry(at));
  EXPECT_EQ(history.choose_oldest().time, time_from_ns(10));
  EXPECT_EQ(history.choose_oldest().time, time_from_ns(20));
  EXPECT_EQ(history.staying(), 1u);
  history.erase(0);
  EXPECT_EQ(history.leaving(), 1u);
  history.erase(1);
  EXPECT_EQ(history.leaving(), 1u);
  EXPECT_EQ(history.staying(), 0u);
}

TEST(EntityHistory, LetsWhatIsOlderThanWhatLeavesLeaveToo) {
  EntityHistory history;
  for (const int64_t at : {10, 20, 30}) history.put(entry(at));
  history.choose_oldest();
  EXPECT_TRUE(history.put(entry(5)).is_leaving);
  EXPECT_FALSE(history.put(entry(15)).is_leaving);
  EXPECT_EQ(history.leaving(), 2u);
  EXPECT_EQ(history.choose_oldest().time, time_from_ns(15));
}

}  // namespace
}  // namespace engram::ltm
