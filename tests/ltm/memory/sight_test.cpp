// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/sight.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace engram::ltm {
namespace {

using Window = TimeWindows::Window;

Window window(int64_t first, int64_t last) {
  return {time_from_ns(first), time_from_ns(last)};
}

TEST(TimeWindows, JoinsWhatTouches) {
  TimeWindows windows;
  EXPECT_TRUE(windows.empty());
  windows.add(window(10, 20));
  windows.add(window(30, 40));
  windows.add(window(9, 8));
  EXPECT_THAT(windows.windows(), ::testing::ElementsAre(window(10, 20), window(30, 40)));
  windows.add(window(21, 22));
  EXPECT_THAT(windows.windows(), ::testing::ElementsAre(window(10, 22), window(30, 40)));
  windows.add(window(15, 35));
  EXPECT_THAT(windows.windows(), ::testing::ElementsAre(window(10, 40)));
  EXPECT_FALSE(windows.is_all());
  windows.add({});
  EXPECT_TRUE(windows.is_all());
  EXPECT_TRUE(TimeWindows::all().is_all());
}

TEST(TimeWindows, JoinsAtTheEndsOfTime) {
  TimeWindows windows;
  windows.add(window(INT64_MIN, -1));
  windows.add(window(0, INT64_MAX));
  EXPECT_TRUE(windows.is_all());
  EXPECT_TRUE(windows.contains(time_from_ns(INT64_MIN)));
  EXPECT_TRUE(windows.contains(time_from_ns(INT64_MAX)));
}

TEST(TimeWindows, ContainWhatAnyOfThemContains) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int64_t> any(0, 60);
  for (int round = 0; round < 200; ++round) {
    TimeWindows windows;
    std::vector<Window> added;
    for (int i = 0; i < 5; ++i) {
      const int64_t first = any(random);
      added.push_back(window(first, first + any(random) / 8));
      windows.add(added.back());
    }
    for (int64_t at = -2; at < 72; ++at) {
      const bool expected = std::ranges::any_of(added, [at](const Window& one) {
        return to_ns(one.first) <= at && at <= to_ns(one.last);
      });
      EXPECT_EQ(windows.contains(time_from_ns(at)), expected) << at;
    }
  }
}

TEST(Sight, OfNoViewIsEverything) {
  EXPECT_TRUE(sight_of(nullptr, *MemoryId::parse("a/b/c/d")).is_all());
}

}  // namespace
}  // namespace engram::ltm
