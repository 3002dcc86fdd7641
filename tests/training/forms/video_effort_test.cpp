// SPDX-License-Identifier: Apache-2.0
#include "training/forms/video_effort.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "ltm/codec/group_codec.h"

namespace engram::training {
namespace {

TEST(VideoEfforts, TakeMoreBytesTheLessTimeTheyTake) {
  const auto ladder = video_efforts();
  EXPECT_EQ(ladder.front().relative_bytes, 1);
  for (size_t i = 1; i < ladder.size(); ++i) {
    EXPECT_GT(ladder[i].relative_bytes, ladder[i - 1].relative_bytes);
    for (const int64_t pixels : {96 * 96, 128 * 128, 200 * 200, 640 * 480, 1920 * 1080})
      EXPECT_LT(seconds_per_image(ladder[i], pixels), seconds_per_image(ladder[i - 1], pixels))
          << ladder[i].codec_options << " at " << pixels;
  }
}

TEST(VideoEfforts, AreOptionsOfTheCodec) {
  if (!ltm::make_group_codec("av1").ok()) GTEST_SKIP() << "no AV1";
  for (const VideoEffort& effort : video_efforts())
    EXPECT_TRUE(ltm::make_group_codec(fmt::format("av1:crf=30,{}", effort.codec_options)).ok())
        << effort.codec_options;
}

TEST(VideoEfforts, TakeTheMeasuredTimeAtTheMeasuredSizes) {
  for (const VideoEffort& effort : video_efforts())
    for (size_t i = 0; i < kMeasuredPixels.size(); ++i)
      EXPECT_NEAR(seconds_per_image(effort, kMeasuredPixels[i]), effort.seconds[i], 1e-9);
}

TEST(VideoPaces, AreTheUsualEffortInTheUsualTime) {
  for (const int64_t pixels : {96 * 96, 128 * 128, 256 * 256, 640 * 480}) {
    const VideoPace pace = pace_within(1, pixels, 0.5);
    EXPECT_EQ(pace.effort, &usual_effort(pixels)) << pixels;
    EXPECT_EQ(pace.tolerance_db, 0.5);
  }
}

TEST(VideoPaces, TakeFewerBytesTheMoreTimeThereIs) {
  double bytes = 10;
  for (const double times : {0.01, 0.3, 0.6, 1.0, 2.0, 5.0, 20.0}) {
    const VideoPace pace = pace_within(times, 640 * 480, 0.5);
    EXPECT_LE(pace.relative_bytes, bytes) << times;
    bytes = pace.relative_bytes;
  }
  const VideoPace slowest = pace_within(25, 640 * 480, 0.5);
  EXPECT_EQ(slowest.effort, &video_efforts().front());
  EXPECT_EQ(slowest.tolerance_db, 0) << "the smallest video that keeps the bound";
  EXPECT_EQ(pace_within(0.01, 640 * 480, 0.5).effort, &video_efforts().back());
  EXPECT_EQ(pace_within(0.5, 640 * 480, 0).tolerance_db, 0) << "as it was asked for";
}

}  // namespace
}  // namespace engram::training
