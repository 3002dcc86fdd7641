// SPDX-License-Identifier: Apache-2.0
#include "training/night/time_shares.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace engram::training {
namespace {

TEST(TimeShares, TrainInWhatEncodingLeavesByWeight) {
  const std::vector<TimeNeed> needs{{10, 1}, {50, 3}};
  const TimeShare first = first_share(needs, 100);
  EXPECT_FALSE(first.is_short);
  EXPECT_DOUBLE_EQ(first.encoding, 10);
  EXPECT_DOUBLE_EQ(first.training, 10) << "a quarter of 40";
  const TimeShare second = first_share(std::span(needs).subspan(1), 100 - first.total());
  EXPECT_DOUBLE_EQ(second.training, 30);
  EXPECT_DOUBLE_EQ(second.total(), 80) << "nothing is left unused";
}

TEST(TimeShares, PassOnWhatAnEntitySaved) {
  const std::vector<TimeNeed> needs{{50, 1}};
  EXPECT_DOUBLE_EQ(first_share(needs, 99).training, 49);
}

TEST(TimeShares, GiveEachAnEvenPartWhereThereIsTooLittle) {
  const std::vector<TimeNeed> needs{{1, 1}, {50, 1}, {60, 1}};
  double left = 61;
  std::vector<double> given;
  for (size_t i = 0; i < needs.size(); ++i) {
    const TimeShare share = first_share(std::span(needs).subspan(i), left);
    EXPECT_TRUE(share.is_short);
    EXPECT_EQ(share.training, 0);
    given.push_back(share.encoding);
    left -= share.total();
  }
  EXPECT_EQ(given, (std::vector<double>{1, 30, 30}));
}

// Half of what one night needs, three times: nothing is skipped again and again because something
// larger comes after it.
TEST(TimeShares, WorkOffABacklogInThreeNightsOfHalfTheTime) {
  for (const std::vector<double>& needs :
       {std::vector<double>{100}, {1, 1, 98}, {10, 20, 30, 40}, {49, 51}, {1, 2, 3, 300}}) {
    std::vector<double> open = needs;
    double all = 0;
    for (const double need : needs) all += need;
    for (int night = 0; night < 3; ++night) {
      std::ranges::sort(open);
      double left = all / 2;
      for (size_t i = 0; i < open.size(); ++i) {
        std::vector<TimeNeed> rest;
        for (size_t j = i; j < open.size(); ++j)
          if (open[j] > 0) rest.push_back({open[j], 1});
        if (open[i] == 0) continue;
        const double given = first_share(rest, left).encoding;
        EXPECT_GT(given, 0);
        open[i] -= given;
        left -= given;
      }
    }
    for (const double need : open) EXPECT_NEAR(need, 0, 1e-9);
  }
}

TEST(TimeShares, AreNothingWhereTheTimeIsOver) {
  const std::vector<TimeNeed> needs{{1, 1}};
  EXPECT_EQ(first_share(needs, -5).total(), 0);
  EXPECT_TRUE(first_share(needs, -5).is_short);
}

}  // namespace
}  // namespace engram::training
