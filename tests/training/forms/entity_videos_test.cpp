// SPDX-License-Identifier: Apache-2.0
#include "training/forms/entity_videos.h"

#include <gtest/gtest.h>

#include "ltm/codec/group_codec.h"
#include "training/forms/video_correction.h"

namespace engram::training {
namespace {

std::vector<idf::NdArray> images_of(uint8_t start) {
  std::vector<idf::NdArray> images;
  for (int i = 0; i < 4; ++i) {
    std::vector<uint8_t> pixels(size_t{32} * 32 * 3);
    for (size_t at = 0; at < pixels.size(); ++at)
      pixels[at] =
          static_cast<uint8_t>(start + (at * 7 + at / 96 * 5 + 3 * static_cast<size_t>(i)) % 60);
    images.push_back(idf::NdArray::take<uint8_t>({32, 32, 3}, std::move(pixels)));
  }
  return images;
}

const VideoSearchOptions kOptions{.codec = "h264", .settings = "effort=1", .bound_db = 34};

TEST(EntityVideos, KnowsOnlyTheSameImages) {
  EntityVideos videos(1, kOptions);
  const auto images = images_of(20);
  EXPECT_FALSE(videos.find(0, images));
  const auto found = videos.search_of(0).search(images);
  ASSERT_TRUE(found.ok() && found->lossy);
  videos.add(images, *found);
  const auto known = videos.find(0, images);
  ASSERT_TRUE(known);
  EXPECT_EQ(known->lossy->bytes, found->lossy->bytes);
  EXPECT_EQ(videos.reused(), 1U);
  EXPECT_FALSE(videos.find(0, images_of(21)));
  EXPECT_FALSE(videos.find(0, std::span(images).first(3)));
  EXPECT_FALSE(videos.without_videos()->find(0, images));
}

TEST(EntityVideos, TakesStoredVideosThatKeepTheBound) {
  const auto images = images_of(40);
  for (const auto& [crf, is_taken] : {std::pair(1, true), std::pair(51, false)}) {
    EntityVideos videos(1, kOptions);
    const auto coder = ltm::make_group_codec(fmt::format("h264:crf={},effort=1", crf));
    const auto bytes = (*coder)->encode(images);
    ASSERT_TRUE(bytes.ok());
    ASSERT_TRUE(videos.add_stored(0, images, encoders::ImageForm::kH264, *bytes, {}).ok());
    EXPECT_EQ(videos.find(0, images).has_value(), is_taken) << crf;
  }
  EntityVideos videos(1, kOptions);
  const auto found = videos.search_of(0).search(images);
  ASSERT_TRUE(found.ok() && found->lossy);
  ASSERT_TRUE(videos
                  .add_stored(0, images, encoders::ImageForm::kH264, found->lossy->bytes,
                              found->lossy->residual)
                  .ok());
  const auto known = videos.find(0, images);
  ASSERT_TRUE(known);
  EXPECT_EQ(known->lossy->mse, found->lossy->mse);
}

TEST(EntityVideos, TakesStoredVideosWithTheirResiduals) {
  const auto images = images_of(40);
  const auto coder = ltm::make_group_codec("h264:crf=40,effort=1");
  const auto bytes = *(*coder)->encode(images);
  const auto decoded = *(*coder)->decode(bytes, images[0].type(), images[0].shape(), 4);
  const auto correction = correct_video(images, decoded, kOptions.bound_db);
  ASSERT_TRUE(correction.ok() && *correction);
  ASSERT_FALSE((*correction)->residual.empty());
  EntityVideos videos(1, kOptions);
  ASSERT_TRUE(videos.add_stored(0, images, encoders::ImageForm::kH264, bytes, {}).ok());
  EXPECT_FALSE(videos.find(0, images)) << "without its residuals it misses the bound";
  ASSERT_TRUE(
      videos.add_stored(0, images, encoders::ImageForm::kH264, bytes, (*correction)->residual)
          .ok());
  const auto known = videos.find(0, images);
  ASSERT_TRUE(known);
  EXPECT_EQ(known->lossy->residual, (*correction)->residual);
  EXPECT_EQ(known->lossy->mse, (*correction)->mse);
  const std::vector<std::byte> damaged(3, std::byte{255});
  EXPECT_FALSE(videos.add_stored(0, images, encoders::ImageForm::kH264, bytes, damaged).ok());
}

TEST(EntityVideos, RefusesDamagedVideos) {
  const auto images = images_of(40);
  EntityVideos videos(1, kOptions);
  const std::vector<std::byte> damaged(100);
  EXPECT_FALSE(videos.add_stored(0, images, encoders::ImageForm::kH264, damaged, {}).ok());
  EXPECT_FALSE(videos.find(0, images));
}

}  // namespace
}  // namespace engram::training
