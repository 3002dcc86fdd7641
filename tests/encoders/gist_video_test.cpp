// SPDX-License-Identifier: Apache-2.0
#include "encoders/gist_video.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "encoders/gist_rows.h"
#include "encoders/latent_chain.h"
#include "ltm/codec/group_codec.h"
#include "ltm/codec/packed_value.h"

namespace engram::encoders {
namespace {

/// A square that moves over shades. It rests from row 8 on.
idf::NdArray moving_image(size_t row, const idf::Shape& shape) {
  std::vector<uint8_t> pixels;
  const auto at = static_cast<int64_t>(std::min<size_t>(row, 8) * 3);
  for (int64_t y = 0; y < shape[0]; ++y)
    for (int64_t x = 0; x < shape[1]; ++x)
      for (int64_t c = 0; c < shape[2]; ++c) {
        const bool is_square = x >= at && x < at + 12 && y > 4 && y < 14;
        const int64_t shade = 60 + 80 * y / shape[0] + 60 * x / shape[1] + 10 * c;
        pixels.push_back(static_cast<uint8_t>(is_square ? 220 - 40 * c : shade));
      }
  return idf::NdArray::take<uint8_t>(shape, std::move(pixels));
}

std::vector<idf::NdArray> moving_images(size_t count, const idf::Shape& shape) {
  std::vector<idf::NdArray> images;
  for (size_t row = 0; row < count; ++row) images.push_back(moving_image(row, shape));
  return images;
}

FrameShape bytes_of_shape(const idf::Shape& shape) {
  return {idf::ElementType::kUInt8, shape};
}

double mse(const idf::NdArray& a, const idf::NdArray& b) {
  const auto x = a.values<uint8_t>();
  const auto y = b.values<uint8_t>();
  double sum = 0;
  for (size_t i = 0; i < x.size(); ++i)
    sum += (double{1} * x[i] - y[i]) * (double{1} * x[i] - y[i]);
  return sum / static_cast<double>(x.size());
}

class GistVideo : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!ltm::make_group_codec("av1").ok()) GTEST_SKIP() << "no AV1 encoder is installed";
  }
};

TEST_F(GistVideo, ShowsWhatWasThere) {
  for (const idf::Shape& shape :
       {idf::Shape{48, 64, 3}, idf::Shape{64, 48, 1}, idf::Shape{480, 640, 3},
        idf::Shape{16, 16, 3}, idf::Shape{17, 301, 1}}) {
    const auto images = moving_images(12, shape);
    const auto gist = encode_gist(images, {.crf = 20, .effort = 3, .gain_db = 0.1});
    ASSERT_TRUE(gist.ok()) << gist.status().to_string();
    const auto decoded = decode_gist(*gist, bytes_of_shape(shape), 12, 12);
    ASSERT_TRUE(decoded.ok()) << decoded.status().to_string();
    ASSERT_EQ(decoded->size(), 12u);
    for (size_t row = 0; row < 12; ++row) {
      EXPECT_EQ((*decoded)[row].shape(), shape);
      EXPECT_LT(mse((*decoded)[row], images[row]), 150) << idf::to_string(shape) << " " << row;
    }
  }
}

TEST_F(GistVideo, InterpolatesBetweenKeptImagesExactly) {
  // With so dear images only the first and the last one are kept.
  const idf::Shape shape{48, 64, 3};
  const auto images = moving_images(9, shape);
  const auto gist = encode_gist(images, {.crf = 30, .effort = 3, .gain_db = 1e6});
  const auto decoded = decode_gist(*gist, bytes_of_shape(shape), 9, 9);
  ASSERT_TRUE(decoded.ok()) << decoded.status().to_string();
  const auto first = decoded->front().values<uint8_t>();
  const auto last = decoded->back().values<uint8_t>();
  for (size_t row = 0; row < 9; ++row) {
    const auto values = (*decoded)[row].values<uint8_t>();
    for (size_t i = 0; i < values.size(); ++i)
      ASSERT_EQ(values[i], ((8 - row) * first[i] + row * last[i] + 4) / 8) << row << " " << i;
  }
}

TEST_F(GistVideo, DecodesTheFirstImagesAlike) {
  const idf::Shape shape{48, 64, 3};
  const auto images = moving_images(12, shape);
  const auto gist = encode_gist(images, {.effort = 3, .gain_db = 0.5});
  const auto all = decode_gist(*gist, bytes_of_shape(shape), 12, 12);
  ASSERT_TRUE(all.ok()) << all.status().to_string();
  for (size_t wanted = 0; wanted <= 12; ++wanted) {
    const auto some = decode_gist(*gist, bytes_of_shape(shape), 12, wanted);
    ASSERT_TRUE(some.ok()) << some.status().to_string();
    EXPECT_EQ(*some, std::vector<idf::NdArray>(all->begin(),
                                               all->begin() + static_cast<ptrdiff_t>(wanted)));
  }
  // What the first image does not need is not even read.
  const auto beginning = std::span(*gist).first(gist->size() - 8);
  const auto one = decode_gist(beginning, bytes_of_shape(shape), 12, 1);
  ASSERT_TRUE(one.ok()) << one.status().to_string();
  EXPECT_EQ(one->front(), all->front());
}

TEST_F(GistVideo, TakesHardlyAnyBytesForStillImages) {
  const idf::Shape shape{48, 64, 3};
  const std::vector<idf::NdArray> still(400, moving_image(0, shape));
  const auto one = encode_gist(std::span(still).first(1), {.effort = 3});
  const auto all = encode_gist(still, {.effort = 3});
  ASSERT_TRUE(one.ok() && all.ok());
  EXPECT_LT(all->size(), one->size() + 200);
}

TEST_F(GistVideo, RefusesWhatIsNoImageOfBytes) {
  const auto code = [](const std::vector<idf::NdArray>& images) {
    return encode_gist(images, {}).status().code();
  };
  EXPECT_EQ(code({}), StatusCode::kInvalidArgument);
  EXPECT_EQ(code({idf::NdArray::take<uint8_t>({8, 64, 3}, std::vector<uint8_t>(8 * 64 * 3))}),
            StatusCode::kInvalidArgument);
  EXPECT_EQ(code({idf::NdArray::take<uint8_t>({64, 64, 2}, std::vector<uint8_t>(64 * 64 * 2))}),
            StatusCode::kInvalidArgument);
  EXPECT_EQ(code({idf::NdArray::take<uint16_t>({64, 64, 1}, std::vector<uint16_t>(64 * 64))}),
            StatusCode::kInvalidArgument);
  EXPECT_EQ(code({moving_image(0, {48, 64, 3}), moving_image(0, {64, 48, 3})}),
            StatusCode::kInvalidArgument);
  EXPECT_EQ(code(std::vector<idf::NdArray>(ltm::kMaxGroupImages + 1, moving_image(0, {16, 16, 1}))),
            StatusCode::kInvalidArgument);
  const auto images = moving_images(2, {48, 64, 3});
  for (const GistOptions& wrong :
       {GistOptions{.crf = 64}, GistOptions{.effort = 10}, GistOptions{.gain_db = -1},
        GistOptions{.max_gap = 0}, GistOptions{.gain_db = std::nan("")}})
    EXPECT_EQ(encode_gist(images, wrong).status().code(), StatusCode::kInvalidArgument);
}

TEST_F(GistVideo, ReadsAnyBytes) {
  const idf::Shape shape{48, 64, 3};
  const auto gist = *encode_gist(moving_images(12, shape), {.effort = 3, .gain_db = 0.5});
  const auto check = [&](std::span<const std::byte> bytes) {
    const auto decoded = decode_gist(bytes, bytes_of_shape(shape), 12, 12);
    if (decoded.ok()) {
      EXPECT_EQ(decoded->size(), 12u);
    } else {
      EXPECT_EQ(decoded.status().code(), StatusCode::kDataLoss) << decoded.status().to_string();
    }
  };
  for (size_t size = 0; size < gist.size(); ++size) check(std::span(gist).first(size));
  for (size_t bit = 0; bit < gist.size() * 8; ++bit) {
    auto damaged = gist;
    damaged[bit / 8] ^= std::byte(1 << (bit % 8));
    check(damaged);
  }
  std::mt19937 random(9);
  for (int round = 0; round < 100; ++round) {
    auto damaged = gist;
    for (int i = 0; i < 4; ++i) damaged[random() % damaged.size()] = std::byte(random());
    check(damaged);
  }
}

TEST_F(GistVideo, RefusesOtherFramesAndCounts) {
  const auto gist = *encode_gist(moving_images(12, {48, 64, 3}), {.effort = 3, .gain_db = 0.5});
  for (const FrameShape& frame :
       {bytes_of_shape({64, 48, 3}), bytes_of_shape({48, 64, 1}), bytes_of_shape({48, 64}),
        bytes_of_shape({4, 4, 3}), bytes_of_shape({1 << 20, 1 << 20, 3}),
        FrameShape{idf::ElementType::kFloat32, {48, 64, 3}}})
    EXPECT_EQ(decode_gist(gist, frame, 12, 12).status().code(), StatusCode::kDataLoss)
        << idf::to_string(frame.shape);
  EXPECT_EQ(decode_gist(gist, bytes_of_shape({48, 64, 3}), 1, 1).status().code(),
            StatusCode::kDataLoss);
}

TEST_F(GistVideo, IsAFormOfImagesInAChain) {
  constexpr size_t kRows = 12;
  const idf::Shape shape{48, 64, 3};
  const auto images = moving_images(kRows, shape);
  const LatentChainCodec codec{{bytes_of_shape(shape), bytes_of_shape(shape)}, {}, {}};
  LatentRows rows;
  rows.images.resize(2);
  rows.images[0].form = ImageForm::kGist;
  rows.images[0].video = *encode_gist(images, {.effort = 3, .gain_db = 0.5});
  rows.images[1].form = ImageForm::kFfv1;
  rows.images[1].video = *(*ltm::make_group_codec("ffv1"))->encode(images);
  const auto chain = codec.encode(rows, kRows);
  for (const size_t wanted : {size_t{3}, kRows}) {
    const auto decoded = codec.decode(chain, kRows, wanted);
    ASSERT_TRUE(decoded.ok()) << decoded.status().to_string();
    EXPECT_EQ(decoded->images[0].form, ImageForm::kGist);
    EXPECT_EQ(decoded->images[0].frames,
              *decode_gist(rows.images[0].video, bytes_of_shape(shape), kRows, wanted));
    EXPECT_EQ(decoded->images[1].frames.size(), wanted);
  }
  const auto codes = describe_chain(chain, kRows, 2);
  ASSERT_TRUE(codes.ok()) << codes.status().to_string();
  EXPECT_EQ(codes->front().form, ImageForm::kGist);
  EXPECT_EQ(codes->front().bytes, rows.images[0].video.size());
  // It is no video that a night may use again, and no form of a background.
  EXPECT_TRUE(codec_name(ImageForm::kGist).empty());
  EXPECT_FALSE(form_of_codec("gist").has_value());
  EXPECT_FALSE(
      decode_background(ImageForm::kGist, rows.images[0].video, bytes_of_shape(shape)).ok());
}

TEST_F(GistVideo, HasNoResiduals) {
  const idf::Shape shape{48, 64, 3};
  const LatentChainCodec codec{{bytes_of_shape(shape)}, {}, {}};
  LatentRows rows;
  rows.images.resize(1);
  rows.images[0].form = ImageForm::kGist;
  rows.images[0].video = *encode_gist(moving_images(2, shape), {.effort = 3});
  auto chain = codec.encode(rows, 2);
  ASSERT_EQ(chain.front(), std::byte{2 * 5});
  for (const int flag : {8, 16, 24}) {
    chain.front() = static_cast<std::byte>(2 * (5 + flag));
    EXPECT_EQ(codec.decode(chain, 2, 2).status().code(), StatusCode::kDataLoss) << flag;
  }
}

using Rows = std::vector<std::vector<uint8_t>>;

TEST(GistRows, AreTheTurnsOfALineAndItsEnds) {
  Rows rows;
  for (int row = 0; row <= 20; ++row)
    rows.emplace_back(50, static_cast<uint8_t>(row < 9 ? 20 * row : 180 - 5 * (row - 9)));
  EXPECT_EQ(choose_gist_rows(rows, {}), (std::vector<size_t>{0, 9, 20}));
  EXPECT_EQ(choose_gist_rows(rows, {.gain_db = 1e6}), (std::vector<size_t>{0, 20}));
  EXPECT_EQ(choose_gist_rows(std::span(rows).first(1), {}), (std::vector<size_t>{0}));
  EXPECT_EQ(choose_gist_rows(rows, {.max_gap = 1}).size(), 21u);
}

TEST(GistRows, AreAtMostTheirMaxGapApart) {
  const Rows still(100, std::vector<uint8_t>(50, 7));
  const auto kept = choose_gist_rows(still, {.max_gap = 10});
  EXPECT_EQ(kept.size(), 11u);
  for (size_t i = 1; i < kept.size(); ++i) EXPECT_LE(kept[i] - kept[i - 1], 10u);
}

}  // namespace
}  // namespace engram::encoders
