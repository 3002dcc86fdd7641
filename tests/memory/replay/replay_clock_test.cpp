// SPDX-License-Identifier: Apache-2.0
#include "memory/replay/replay_clock.h"

#include <gtest/gtest.h>

namespace engram::memory {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class ReplayClockTest : public ::testing::Test {
 protected:
  static Time at(int64_t s) { return time_from_ns(s * 1'000'000'000); }

  SteadyTime steady_{};
  ReplayClock clock_{at(100), 2, [this] { return steady_; }};
};

TEST_F(ReplayClockTest, GoesAtItsSpeedWhilePlaying) {
  steady_ += seconds(5);
  EXPECT_EQ(clock_.now(), at(100));
  clock_.set_playing(true);
  steady_ += seconds(5);
  EXPECT_EQ(clock_.now(), at(110));
  clock_.set_speed(0.5);
  steady_ += seconds(4);
  EXPECT_EQ(clock_.now(), at(112));
  clock_.set_playing(false);
  steady_ += seconds(4);
  EXPECT_EQ(clock_.now(), at(112));
}

TEST_F(ReplayClockTest, TellsHowLongUntilAMoment) {
  EXPECT_EQ(clock_.until(at(100)), Duration(0));
  EXPECT_EQ(clock_.until(at(101)), Duration::max());
  clock_.set_playing(true);
  const Duration wait = clock_.until(at(110));
  EXPECT_GE(wait, seconds(5));
  EXPECT_LT(wait, seconds(5) + milliseconds(1));
  steady_ += wait;
  EXPECT_GE(clock_.now(), at(110));
}

TEST_F(ReplayClockTest, NeverPassesTheEndOfALoopByItself) {
  clock_.set_playing(true);
  clock_.set_loop(ReplayLoop{at(90), at(120)});
  steady_ += seconds(60);
  EXPECT_EQ(clock_.now(), at(120));
  clock_.jump(at(130));
  steady_ += seconds(1);
  EXPECT_EQ(clock_.now(), at(132));
  EXPECT_EQ(clock_.course().jumps, 1u);
  clock_.set_loop({});
  steady_ += seconds(1000);
  EXPECT_EQ(clock_.now(), at(2132));
}

TEST_F(ReplayClockTest, StaysWithinItsRange) {
  clock_.jump(Time::max() - seconds(1));
  clock_.set_playing(true);
  steady_ += seconds(3600);
  EXPECT_EQ(clock_.now(), Time::max());
}

TEST_F(ReplayClockTest, AdvancesToALaterMomentAlone) {
  clock_.advance(at(50));
  EXPECT_EQ(clock_.now(), at(100));
  clock_.advance(at(150));
  EXPECT_EQ(clock_.now(), at(150));
  EXPECT_EQ(clock_.course().jumps, 0u);
}

}  // namespace
}  // namespace engram::memory
