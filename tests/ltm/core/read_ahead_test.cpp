// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/read_ahead.h"

#include <gmock/gmock.h>

#include <atomic>
#include <chrono>

#include "tests/ltm/expect_status.h"

namespace engram {
namespace {

using Numbers = ReadAhead<int>;

size_t ten_bytes(const int& /*number*/) {
  return 10;
}

TEST(ReadAhead, GivesItemsInOrderAndTheEndAgainAndAgain) {
  int next = 0;
  Numbers ahead(
      [&]() -> Numbers::Item { return next < 1000 ? std::optional(next++) : std::nullopt; },
      ten_bytes, 100);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(ahead.next().value(), i);
  EXPECT_EQ(ahead.next().value(), std::nullopt);
  EXPECT_EQ(ahead.next().value(), std::nullopt);
}

TEST(ReadAhead, GivesWhatCameBeforeAnError) {
  int next = 0;
  Numbers ahead(
      [&]() -> Numbers::Item {
        if (next == 3) return data_loss("broken");
        return std::optional(next++);
      },
      ten_bytes, 100);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(ahead.next().value(), i);
  EXPECT_FAILS(ahead.next(), StatusCode::kDataLoss, "broken");
  EXPECT_FAILS(ahead.next(), StatusCode::kDataLoss, "broken");
}

TEST(ReadAhead, StaysWithinItsLimit) {
  using namespace std::chrono_literals;
  std::atomic<int> made = 0;
  Numbers ahead([&]() -> Numbers::Item { return std::optional(made++); }, ten_bytes, 50);
  for (int taken = 0; taken < 100; ++taken) {
    if (taken % 10 == 0) std::this_thread::sleep_for(1ms);
    EXPECT_LE(made, taken + 5 + 1) << "what waits, and one that finds no room";
    EXPECT_EQ(ahead.next().value(), taken);
  }
}

TEST(ReadAhead, TakesItemsThatAreLargerThanItsLimit) {
  int next = 0;
  Numbers ahead([&]() -> Numbers::Item { return std::optional(next++); }, ten_bytes, 1);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(ahead.next().value(), i);
}

TEST(ReadAhead, EndsWhileItemsWait) {
  std::atomic<int> made = 0;
  {
    Numbers ahead([&]() -> Numbers::Item { return std::optional(made++); }, ten_bytes, 50);
    EXPECT_EQ(ahead.next().value(), 0);
  }
  EXPECT_GE(made, 1);
}

}  // namespace
}  // namespace engram
