// SPDX-License-Identifier: Apache-2.0
#include "server/access/rate_limit.h"

#include <atomic>
#include <limits>
#include <thread>
#include <vector>

#include "tests/ltm/expect_status.h"

namespace engram::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

int takes(RateLimit& limit, SteadyTime now, int tries = 10'000) {
  int taken = 0;
  for (int i = 0; i < tries; ++i) taken += limit.take(now) ? 1 : 0;
  return taken;
}

TEST(RateLimit, LetsOneSecondsWorthThroughAtOnceAndThenTheRate) {
  const SteadyTime start{seconds(100)};
  RateLimit limit(50, start);
  EXPECT_EQ(takes(limit, start), 50);
  EXPECT_EQ(takes(limit, start + milliseconds(100)), 5);
  EXPECT_EQ(takes(limit, start + seconds(1)), 45);
  EXPECT_EQ(takes(limit, start + seconds(1000)), 50) << "what was not used is not saved up";
}

TEST(RateLimit, LetsOneThroughOfLessThanOnePerSecond) {
  const SteadyTime start{seconds(100)};
  RateLimit limit(0.1, start);
  EXPECT_EQ(takes(limit, start), 1);
  EXPECT_EQ(takes(limit, start + seconds(9)), 0);
  EXPECT_EQ(takes(limit, start + seconds(11)), 1);
}

TEST(RateLimit, TakesManyAtOnceOrNone) {
  const SteadyTime start{std::chrono::seconds(7)};
  RateLimit limit(50, start);
  EXPECT_FALSE(limit.take(start, 51));
  EXPECT_TRUE(limit.take(start, 40));
  EXPECT_FALSE(limit.take(start, 11));
  EXPECT_TRUE(limit.take(start, 10));
  EXPECT_TRUE(limit.take(start + std::chrono::seconds(1), 50));
}

TEST(RateLimit, GivesNothingForTimesThatComeLate) {
  const SteadyTime start{seconds(100)};
  RateLimit limit(10, start);
  EXPECT_EQ(takes(limit, start + seconds(1)), 10);
  EXPECT_EQ(takes(limit, start), 0);
  EXPECT_EQ(takes(limit, start + seconds(1)), 0);
}

TEST(RateLimit, IsExactForManyThreads) {
  const SteadyTime start{seconds(100)};
  RateLimit limit(1000, start);
  std::atomic<int> taken{0};
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 4; ++i) threads.emplace_back([&] { taken += takes(limit, start, 500); });
  }
  EXPECT_EQ(taken, 1000);
}

TEST(RateLimitDeathTest, NeedsARateThatIsOne) {
  EXPECT_DEATH(RateLimit(0, {}), "rate is 0");
  EXPECT_DEATH(RateLimit(std::numeric_limits<double>::infinity(), {}), "rate is inf");
}

}  // namespace
}  // namespace engram::server
