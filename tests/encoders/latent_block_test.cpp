// SPDX-License-Identifier: Apache-2.0
#include "encoders/latent_block.h"

#include <gtest/gtest.h>

#include <random>

#include "ltm/codec/group_codec.h"

namespace engram::encoders {
namespace {

constexpr size_t kRows = 6;

LatentBlockCodec codec() {
  LatentBlockCodec codec;
  const std::vector<LatentGrid> grids{{3, 2, 2}, {2, 4, 4}};
  codec.images.emplace_back(LatentModel(grids));
  codec.images.emplace_back(LatentModel(grids));
  codec.numbers.emplace(*NumberModel::create({{NumberKind::kBounded, 2, 0.01}}));
  codec.frames.assign(2, {idf::ElementType::kUInt8, {64, 64, 3}});
  codec.scenes = 3;
  return codec;
}

LatentRows some_rows() {
  std::mt19937 random(7);
  LatentRows rows;
  rows.scene = 2;
  for (int image = 0; image < 2; ++image) {
    auto& integers = rows.images.emplace_back().latents;
    for (size_t i = 0; i < kRows * (3 * 4 + 2 * 16); ++i)
      integers.push_back(static_cast<int32_t>(random() % 7) - 3);
  }
  for (size_t i = 0; i < kRows * 2; ++i) rows.numbers.push_back(0.37 * static_cast<double>(i));
  return rows;
}

TEST(LatentBlock, GivesBackWhatItWasGiven) {
  const LatentRows rows = some_rows();
  const auto block = codec().encode(rows, kRows);
  const auto decoded = codec().decode(block, kRows, kRows);
  ASSERT_TRUE(decoded.ok()) << decoded.status().to_string();
  EXPECT_EQ(decoded->scene, 2u);
  EXPECT_EQ(decoded->images, rows.images);
  ASSERT_EQ(decoded->numbers.size(), rows.numbers.size());
  for (size_t i = 0; i < rows.numbers.size(); ++i)
    EXPECT_NEAR(decoded->numbers[i], rows.numbers[i], 0.01);
}

TEST(LatentBlock, DecodesOnlyTheRowsThatAreWanted) {
  const LatentRows rows = some_rows();
  const auto block = codec().encode(rows, kRows);
  const auto decoded = codec().decode(block, kRows, 2);
  ASSERT_TRUE(decoded.ok()) << decoded.status().to_string();
  ASSERT_EQ(decoded->images[1].latents.size(), 2u * (3 * 4 + 2 * 16));
  EXPECT_TRUE(std::equal(decoded->images[1].latents.begin(), decoded->images[1].latents.end(),
                         rows.images[1].latents.begin()));
  EXPECT_EQ(decoded->numbers.size(), 4u);
}

TEST(LatentBlock, HoldsVideosInsteadOfLatents) {
  std::vector<idf::NdArray> images;
  for (size_t row = 0; row < kRows; ++row)
    images.push_back(idf::NdArray::take<uint8_t>(
        {64, 64, 3}, std::vector<uint8_t>(64 * 64 * 3, static_cast<uint8_t>(row * 9))));
  LatentRows rows = some_rows();
  rows.images[1].latents.clear();
  rows.images[1].form = *form_of_codec("ffv1");
  rows.images[1].video = *(*ltm::make_group_codec("ffv1"))->encode(images);
  const auto decoded = codec().decode(codec().encode(rows, kRows), kRows, 3);
  ASSERT_TRUE(decoded.ok()) << decoded.status().to_string();
  EXPECT_EQ(decoded->images[1].form, ImageForm::kFfv1);
  EXPECT_EQ(decoded->images[1].frames, images);
  EXPECT_EQ(decoded->images[0].latents.size(), 3u * (3 * 4 + 2 * 16));
  EXPECT_FALSE(form_of_codec("png").has_value());
}

/// Rows on backgrounds of their own: a shaded one and an even one.
LatentRows rows_with_backgrounds() {
  std::vector<uint8_t> shades(64 * 64 * 3);
  for (size_t i = 0; i < shades.size(); ++i) shades[i] = static_cast<uint8_t>(i / 64 + i % 3 * 10);
  LatentRows rows = some_rows();
  for (auto& pixels : {shades, std::vector<uint8_t>(64 * 64 * 3, 90)})
    rows.own.push_back(**code_background(idf::NdArray::take<uint8_t>({64, 64, 3}, pixels), 0));
  return rows;
}

TEST(LatentBlock, HoldsBackgroundsOfItsOwn) {
  const LatentRows rows = rows_with_backgrounds();
  const auto decoded = codec().decode(codec().encode(rows, kRows), kRows, kRows);
  ASSERT_TRUE(decoded.ok()) << decoded.status().to_string();
  EXPECT_EQ(decoded->own, rows.own);
  EXPECT_EQ(decoded->scene, rows.scene);
  EXPECT_EQ(decoded->images, rows.images);
}

TEST(LatentBlock, RefusesABackgroundThatIsNone) {
  LatentRows rows = rows_with_backgrounds();
  rows.own[1].bytes.assign(40, std::byte{0x5a});
  EXPECT_EQ(codec().decode(codec().encode(rows, kRows), kRows, kRows).status().code(),
            StatusCode::kDataLoss);
  rows.own[1].form = ImageForm::kLatents;
  EXPECT_EQ(codec().decode(codec().encode(rows, kRows), kRows, kRows).status().code(),
            StatusCode::kDataLoss);
}

TEST(LatentBlock, FindsEveryFlippedBitAndEveryMissingByte) {
  const auto block = codec().encode(some_rows(), kRows);
  for (size_t bit = 0; bit < block.size() * 8; ++bit) {
    auto damaged = block;
    damaged[bit / 8] ^= std::byte(1 << (bit % 8));
    EXPECT_EQ(codec().decode(damaged, kRows, kRows).status().code(), StatusCode::kDataLoss) << bit;
  }
  for (size_t size = 0; size < block.size(); ++size)
    EXPECT_FALSE(codec().decode(std::span(block).first(size), kRows, kRows).ok()) << size;
  EXPECT_FALSE(codec().decode(block, kRows + 1, kRows).ok());
}

}  // namespace
}  // namespace engram::encoders
