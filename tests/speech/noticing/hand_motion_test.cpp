// SPDX-License-Identifier: Apache-2.0
#include "speech/noticing/hand_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace engram::speech {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

/// A hand at 20 samples a second that goes from one opening to the next in so many seconds each.
class HandAt {
 public:
  explicit HandAt(double open) : open_(open) {}

  HandAt& stay(double seconds) { return go(open_, seconds); }
  HandAt& go(double to, double seconds) {
    const auto steps = static_cast<int>(seconds * 20);
    const double from = open_;
    for (int i = 1; i <= steps; ++i) {
      open_ = from + (to - from) * i / steps;
      samples_.push_back({Time(std::chrono::milliseconds(50) * samples_.size()),
                          open_ + noise_ * spread_(random_)});
    }
    return *this;
  }
  HandAt& shake(double noise) {
    noise_ = noise;
    return *this;
  }
  [[nodiscard]] const std::vector<HandSample>& samples() const { return samples_; }

 private:
  double open_;
  double noise_ = 0;
  std::vector<HandSample> samples_;
  std::mt19937 random_{1};
  std::uniform_real_distribution<double> spread_{-1, 1};
};

std::vector<Grasp> grasps_of(const HandAt& hand) {
  return grasps_in(hand.samples(), min_swing(hand.samples()));
}

double second_of(const HandAt& hand, size_t at) {
  return to_seconds(hand.samples()[at].time.time_since_epoch());
}

TEST(HandMotion, FindsWhatAHandHeld) {
  HandAt hand(0.4);
  hand.stay(1).go(0.8, 0.5).stay(1.5).go(0.5, 0.8).stay(3).go(0.8, 0.5).stay(1);
  const auto grasps = grasps_of(hand);
  ASSERT_THAT(grasps, SizeIs(1));
  EXPECT_NEAR(second_of(hand, grasps[0].close.began), 3.0, 0.15);
  EXPECT_NEAR(second_of(hand, grasps[0].close.ended), 3.8, 0.15);
  ASSERT_TRUE(grasps[0].has_let_go);
  EXPECT_NEAR(second_of(hand, grasps[0].open.began), 6.8, 0.15);
  EXPECT_NEAR(grasps[0].close.before, 0.8, 0.01);
  EXPECT_NEAR(grasps[0].close.after, 0.5, 0.01);
}

TEST(HandMotion, TakesNoHandThatGoesBackToRest) {
  HandAt hand(0.4);
  hand.stay(1).go(0.8, 0.5).stay(1).go(0.5, 0.8).stay(3).go(0.8, 0.5).stay(1).go(0.4, 0.5).stay(2);
  EXPECT_THAT(grasps_of(hand), SizeIs(1));
  hand.stay(2);
  EXPECT_THAT(grasps_of(hand), SizeIs(2));
}

TEST(HandMotion, TakesAHandThatLoosensForOneThatHolds) {
  HandAt hand(0.8);
  hand.stay(1).go(0.5, 0.8).stay(0.2).go(0.58, 4).go(0.8, 0.4).stay(1);
  const auto grasps = grasps_of(hand);
  ASSERT_THAT(grasps, SizeIs(1));
  EXPECT_NEAR(second_of(hand, grasps[0].open.middle), 6.1, 0.2);
}

TEST(HandMotion, KnowsWhatItHoldsStill) {
  HandAt hand(0.8);
  hand.stay(2).go(0.4, 1).stay(5);
  const auto grasps = grasps_of(hand);
  ASSERT_THAT(grasps, SizeIs(1));
  EXPECT_FALSE(grasps[0].has_let_go);
}

TEST(HandMotion, FindsTwoOneAfterTheOther) {
  HandAt hand(0.8);
  hand.shake(0.01).stay(2).go(0.4, 1).stay(3).go(0.8, 1).stay(2).go(0.45, 1).stay(3).go(0.8, 1);
  EXPECT_THAT(grasps_of(hand), SizeIs(2));
}

TEST(HandMotion, CutsCreepingOffItsEnds) {
  // Half a minute of creeping by a twentieth of the way, and then it closes.
  HandAt hand(0.8);
  hand.go(0.785, 15).go(0.5, 0.6).go(0.49, 10).go(0.8, 1).stay(1);
  const auto grasps = grasps_of(hand);
  ASSERT_THAT(grasps, SizeIs(1));
  EXPECT_NEAR(second_of(hand, grasps[0].close.began), 15.0, 0.2);
  EXPECT_NEAR(second_of(hand, grasps[0].close.ended), 15.6, 0.2);
}

TEST(HandMotion, TakesNoNoiseForDeeds) {
  HandAt still(0.5);
  still.stay(10);
  EXPECT_THAT(grasps_of(still), IsEmpty());
  HandAt shaking(0.5);
  shaking.shake(0.05).stay(60);
  EXPECT_THAT(grasps_of(shaking), IsEmpty());
  EXPECT_THAT(grasps_in({}, 0.1), IsEmpty());
  EXPECT_THAT(grasps_of(HandAt(0.5).stay(0.1)), IsEmpty());
}

}  // namespace
}  // namespace engram::speech
