// SPDX-License-Identifier: Apache-2.0
#include "training/forms/video_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "ltm/codec/group_codec.h"
#include "training/forms/video_correction.h"
#include "training/quality/psnr.h"

namespace engram::training {
namespace {

/// A disc that moves over a textured ground.
std::vector<idf::NdArray> images(size_t count) {
  constexpr int kSide = 64;
  std::vector<idf::NdArray> images;
  for (size_t i = 0; i < count; ++i) {
    std::vector<uint8_t> pixels;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const int dx = x - 20 - 2 * static_cast<int>(i);
        const bool is_disc = dx * dx + (y - 32) * (y - 32) < 100;
        for (int c = 0; c < 3; ++c)
          pixels.push_back(
              static_cast<uint8_t>(is_disc ? 200 - 40 * c : 60 + (x * 7 + y * 13 + 5 * c) % 40));
      }
    images.push_back(idf::NdArray::take<uint8_t>({kSide, kSide, 3}, std::move(pixels)));
  }
  return images;
}

double lowest_db(const FoundVideo& video) {
  return psnr_db(*std::ranges::max_element(video.mse));
}

TEST(VideoSearch, FindsTheWorstQualityThatKeepsTheBound) {
  const auto run = images(6);
  VideoSearch search({.codec = "h264", .settings = "effort=1", .bound_db = 36});
  const auto found = search.find(run);
  ASSERT_TRUE(found.ok()) << found.status().to_string();
  ASSERT_TRUE(found->has_value());
  EXPECT_EQ((*found)->form, encoders::ImageForm::kH264);
  EXPECT_GE(lowest_db(**found), 36);
  const auto worse = ltm::make_group_codec(
      fmt::format("h264:crf={},effort=1", static_cast<int>((*found)->quality) + 1));
  const auto decoded = (*worse)->decode(*(*worse)->encode(run), run[0].type(), run[0].shape(), 6);
  double largest = 0;
  for (size_t i = 0; i < run.size(); ++i)
    largest = std::max(largest, *image_mse(run[i], (*decoded)[i]));
  EXPECT_LT(psnr_db(largest), 36);
}

/// Images full of noise, of which the last one has more.
std::vector<idf::NdArray> images_with_a_hard_one() {
  std::vector<idf::NdArray> run;
  uint32_t random = 1;
  for (int i = 0; i < 12; ++i) {
    std::vector<uint8_t> pixels;
    for (int at = 0; at < 64 * 64 * 3; ++at) {
      random = random * 1664525 + 1013904223;
      const uint32_t noise = (random >> 16) % (i == 11 ? 24 : 13);
      pixels.push_back(static_cast<uint8_t>(90 + noise + static_cast<uint32_t>(at / 3 % 64)));
    }
    run.push_back(idf::NdArray::take<uint8_t>({64, 64, 3}, std::move(pixels)));
  }
  return run;
}

TEST(VideoSearch, CorrectsTheImageThatMissesTheBoundAlone) {
  const auto run = images_with_a_hard_one();
  VideoSearch search({.codec = "h264", .settings = "effort=1", .bound_db = 36});
  const auto found = search.search(run);
  ASSERT_TRUE(found.ok() && found->lossy);
  const FoundVideo& video = *found->lossy;
  ASSERT_FALSE(video.residual.empty());
  EXPECT_GE(lowest_db(video), 36);
  // It is smaller than the best that keeps the bound without residuals.
  for (const VideoTrial& trial : found->trials) {
    if (trial.worst_db < 36) continue;
    EXPECT_LT(video.size(), trial.bytes) << trial.crf;
  }
  // A reader sees what the search measured.
  const auto coder = ltm::make_group_codec("h264");
  auto decoded = *(*coder)->decode(video.bytes, run[0].type(), run[0].shape(), run.size());
  ASSERT_TRUE(apply_residuals(video.residual, decoded).ok());
  for (size_t i = 0; i < run.size(); ++i) EXPECT_EQ(*image_mse(run[i], decoded[i]), video.mse[i]);
}

TEST(VideoSearch, FindsTheSameFromAnotherStart) {
  const auto run = images(6);
  VideoSearch search({.codec = "h264", .settings = "effort=1", .bound_db = 36});
  const auto first = search.find(run);
  const auto again = search.find(run);
  ASSERT_TRUE(first.ok() && again.ok());
  EXPECT_EQ((*first)->quality, (*again)->quality);
  EXPECT_EQ((*first)->bytes, (*again)->bytes);
}

TEST(VideoSearch, KeepsWithoutLossWhatNoQualityReaches) {
  VideoSearch search({.codec = "h264", .settings = "effort=1", .bound_db = 59.9});
  const auto found = search.find(images(3));
  ASSERT_TRUE(found.ok()) << found.status().to_string();
  ASSERT_TRUE(found->has_value());
  EXPECT_EQ((*found)->form, encoders::ImageForm::kFfv1);
  EXPECT_EQ((*found)->mse, (std::vector<double>{0, 0, 0}));
}

TEST(VideoSearch, FindsNothingForWhatNoCodecTakes) {
  const std::vector<idf::NdArray> tiny{
      idf::NdArray::take<uint8_t>({8, 8, 3}, std::vector<uint8_t>(8 * 8 * 3))};
  VideoSearch search({.codec = "h264", .settings = "effort=1", .bound_db = 36});
  const auto found = search.find(tiny);
  ASSERT_TRUE(found.ok()) << found.status().to_string();
  const bool takes = (*ltm::make_group_codec("ffv1"))->accepts(tiny[0].type(), tiny[0].shape());
  EXPECT_EQ(found->has_value(), takes);
}

TEST(VideoSearch, NeedsOneEncodeOnceItKnowsTheImages) {
  VideoSearch search({.codec = "h264", .settings = "effort=1", .bound_db = 36, .tolerance_db = 1});
  for (int chain = 0; chain < 6; ++chain) {
    const auto found = search.find(images(6));
    ASSERT_TRUE(found.ok() && found->has_value());
    EXPECT_GE(lowest_db(**found), 36);
    EXPECT_LE(lowest_db(**found), 38);
  }
  const auto encodes = search.history().encodes();
  ASSERT_EQ(encodes.size(), 6U);
  EXPECT_GT(encodes.front(), 1);
  EXPECT_EQ(encodes.back(), 1);
}

TEST(VideoSearch, BeginsWhereAnEarlierJobEnded) {
  const VideoSearchOptions options{
      .codec = "h264", .settings = "effort=1", .bound_db = 36, .tolerance_db = 1};
  VideoSearch first(options);
  for (int chain = 0; chain < 6; ++chain) ASSERT_TRUE(first.find(images(6)).ok());
  VideoSearch second(options);
  second.go_on_from(first.history().line());
  ASSERT_TRUE(second.find(images(6)).ok());
  ASSERT_EQ(second.history().encodes().size(), 1U);
  EXPECT_EQ(second.history().encodes().front(), 1);
}

TEST(VideoSearch, LearnsNothingFromALineThatNoCodecHas) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const VideoHistory::Line& line : std::vector<VideoHistory::Line>{{0, 30, 36, 1},
                                                                        {-1, 30, 36, 1},
                                                                        {kNan, 30, 36, 1},
                                                                        {0.3, kNan, 36, 1},
                                                                        {0.3, 1e300, 36, 1},
                                                                        {0.3, 30, -1e9, 1},
                                                                        {0.3, 30, 36, kNan},
                                                                        {0.3, 30, 36, -1}}) {
    VideoHistory history(0.3);
    history.go_on_from(line);
    EXPECT_TRUE(history.is_empty()) << line.slope << " " << line.at_crf << " " << line.at_db;
  }
}

TEST(VideoSearch, KeepsTheBoundWhereImagesChangeAtOnce) {
  VideoSearch search(
      {.codec = "h264", .settings = "effort=1", .bound_db = 36, .tolerance_db = 0.5});
  std::vector<idf::NdArray> grey;
  for (int i = 0; i < 4; ++i)
    grey.push_back(
        idf::NdArray::take<uint8_t>({64, 64, 3}, std::vector<uint8_t>(size_t{64} * 64 * 3, 90)));
  for (int round = 0; round < 3; ++round)
    for (const auto& run : {images(6), grey}) {
      const auto found = search.find(run);
      ASSERT_TRUE(found.ok() && found->has_value());
      EXPECT_GE(lowest_db(**found), 36);
    }
}

TEST(VideoSearch, LeavesTheLosslessCodecWhereItCannotWin) {
  VideoSearch search({.codec = "h264", .settings = "effort=1", .bound_db = 30});
  const auto first = search.search(images(6));
  ASSERT_TRUE(first.ok());
  ASSERT_TRUE(first->lossless && first->lossy);
  ASSERT_GT(first->lossless->bytes.size(), 2 * first->lossy->bytes.size());
  search.learn(*first);
  const auto second = search.search(images(6));
  ASSERT_TRUE(second.ok());
  EXPECT_FALSE(second->lossless);
}

}  // namespace
}  // namespace engram::training
