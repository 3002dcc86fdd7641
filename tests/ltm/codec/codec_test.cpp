// SPDX-License-Identifier: Apache-2.0
// The suite that every codec passes: ltm/codec/codec.h.
#include "ltm/codec/codec.h"

#include <sys/resource.h>

#include <algorithm>
#include <cstring>
#include <thread>

#include "tests/ltm/codec/test_images.h"
#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

using idf::ElementType;
using idf::NdArray;
using idf::Shape;

std::vector<std::string> texts() {
  return {"png",     "png:0",     "png:level=1", "zstd",     "zstd:1",  "rowpred",
          "shuffle", "shuffle:1", "jpeg",        "jpeg:100", "jpeg:30", "ffv1"};
}

/// These store no shape: they cannot tell 12 x 10 from 10 x 12.
bool knows_shapes(const Codec& codec) {
  return codec.name() != "zstd" && codec.name() != "shuffle";
}

class CodecTest : public ::testing::TestWithParam<std::string> {
 protected:
  const Codec& codec() { return *codec_; }

  void expect_round_trip(const NdArray& array) {
    const Buffer before = Buffer::copy(array.bytes());
    const auto bytes = codec().encode(array);
    ASSERT_OK(bytes);
    EXPECT_TRUE(std::ranges::equal(array.bytes(), before.bytes())) << "encoding changed the array";
    // Whoever decodes knows the name alone.
    const auto decoded = find_codec(codec().name())->decode(*bytes, array.type(), array.shape());
    ASSERT_OK(decoded);
    EXPECT_EQ(decoded->type(), array.type());
    EXPECT_EQ(decoded->shape(), array.shape());
    if (codec().is_lossless()) {
      EXPECT_EQ(*decoded, array);
    }
    EXPECT_EQ(*codec().encode(array), *bytes) << "the same array gives other bytes";
  }

  const std::shared_ptr<const Codec> codec_ = *make_codec(GetParam());
};

TEST_P(CodecTest, GivesBackWhatItAccepts) {
  RandomValues random(13);
  for (int code = 1; code <= 10; ++code)
    for (const Shape& shape :
         {Shape{}, Shape{1}, Shape{0}, Shape{3, 0, 2}, Shape{5, 7}, Shape{1, 1, 1}, Shape{9, 8, 1},
          Shape{0, 5, 3}, Shape{5, 0, 1}, Shape{1, 9, 3}, Shape{9, 1, 3}, Shape{6, 7, 2},
          Shape{13, 11, 3}, Shape{4, 3, 4}, Shape{2, 3, 4, 5}, Shape{33, 65, 3}}) {
      const ElementType type = *idf::element_type_from_code(static_cast<uint8_t>(code));
      const NdArray array = random_array(type, shape, random);
      if (codec().accepts(type, shape))
        expect_round_trip(array);
      else
        EXPECT_FAILS(codec().encode(array), StatusCode::kInvalidArgument, idf::to_string(shape));
    }
}

TEST_P(CodecTest, GivesBackImagesThatFillTheRangeOfTheirNumbers) {
  for (const uint8_t value : {0, 1, 127, 128, 254, 255}) {
    std::vector<uint8_t> pixels(31 * 17 * 3, value);
    for (size_t i = 0; i < pixels.size(); i += 7) pixels[i] = static_cast<uint8_t>(255 - value);
    expect_round_trip(NdArray::take({31, 17, 3}, std::move(pixels)));
  }
}

TEST_P(CodecTest, KeepsSmoothImagesAsWellAsItSays) {
  for (const int64_t channels : {1, 3}) {
    const NdArray image = smooth_image(120, 161, channels);
    const auto decoded = codec().decode(*codec().encode(image), ElementType::kUInt8, image.shape());
    ASSERT_OK(decoded);
    EXPECT_GE(psnr_db(image, *decoded), codec().psnr_db());
    EXPECT_EQ(std::isinf(codec().psnr_db()), codec().is_lossless());
  }
}

TEST_P(CodecTest, GivesBackAHugeImage) {
  expect_round_trip(smooth_image(4096, 4096, 1));
}

TEST_P(CodecTest, RefusesBytesOfAnotherTypeOrShape) {
  RandomValues random(14);
  const NdArray array = random_array(ElementType::kUInt8, {12, 10, 1}, random);
  const auto bytes = *codec().encode(array);
  for (const Shape& shape : {Shape{10, 12, 1}, Shape{12, 10, 3}, Shape{24, 10, 1}, Shape{},
                             Shape{0}, Shape{-1, 10, 1}, Shape{INT64_MAX, INT64_MAX, 1}}) {
    if (!knows_shapes(codec()) && shape == Shape{10, 12, 1}) continue;
    EXPECT_FAILS(codec().decode(bytes, array.type(), shape), StatusCode::kDataLoss, "");
  }
  EXPECT_FAILS(codec().decode(bytes, ElementType::kUInt16, array.shape()), StatusCode::kDataLoss,
               "");
  EXPECT_FAILS(codec().decode({}, array.type(), array.shape()), StatusCode::kDataLoss, "");
}

TEST_P(CodecTest, SurvivesEveryTruncationAndRandomFlips) {
  RandomValues random(15);
  for (const NdArray& array :
       {random_array(ElementType::kUInt8, {9, 8, 3}, random), smooth_image(24, 20, 1)}) {
    const auto bytes = *codec().encode(array);
    const auto expect_same_size_or_error = [&](std::span<const std::byte> damaged) {
      const auto decoded = codec().decode(damaged, array.type(), array.shape());
      if (!decoded.ok()) {
        EXPECT_FAILS(decoded, StatusCode::kDataLoss, "");
        return;
      }
      EXPECT_EQ(decoded->shape(), array.shape());
      EXPECT_EQ(decoded->bytes().size(), array.bytes().size());
    };
    for (size_t size = 0; size < bytes.size(); ++size)
      expect_same_size_or_error({bytes.data(), size});
    for (int i = 0; i < 1500; ++i) {
      auto damaged = bytes;
      for (size_t flips = 1 + random.below(3); flips > 0; --flips)
        damaged[random.below(damaged.size())] = static_cast<std::byte>(random.bits());
      expect_same_size_or_error(damaged);
    }
  }
}

TEST_P(CodecTest, GivesTheSameFromFourThreadsAtOnce) {
  const NdArray image = smooth_image(64, 50, 3);
  const auto bytes = *codec().encode(image);
  const auto plain = *codec().decode(bytes, image.type(), image.shape());
  std::array<bool, 4> is_same{};
  {
    std::vector<std::jthread> threads;
    for (bool& same : is_same)
      threads.emplace_back([&] {
        same = true;
        for (int i = 0; i < 20; ++i)
          same = same && *codec().encode(image) == bytes &&
                 *codec().decode(bytes, image.type(), image.shape()) == plain;
      });
  }
  EXPECT_THAT(is_same, ::testing::Each(true));
}

std::string test_name(const ::testing::TestParamInfo<std::string>& chosen) {
  std::string name = chosen.param;
  std::ranges::replace_if(
      name, [](char c) { return c == ':' || c == '='; }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, CodecTest, ::testing::ValuesIn(texts()), test_name);

TEST(Codecs, AreAllInTheSuite) {
  for (const Codec* codec : all_codecs())
    EXPECT_THAT(texts(), ::testing::Contains(std::string(codec->name())));
}

TEST(Codecs, AreFoundByTheirName) {
  for (const Codec* codec : all_codecs()) EXPECT_EQ(find_codec(codec->name()), codec);
  EXPECT_EQ(find_codec("gif"), nullptr);
}

TEST(Codecs, AreMadeFromTheirText) {
  EXPECT_EQ((*make_codec("jpeg:quality=80"))->name(), "jpeg");
  const NdArray image = smooth_image(100, 100, 3);
  EXPECT_LT((*make_codec("jpeg:50"))->encode(image)->size(),
            (*make_codec("jpeg:95"))->encode(image)->size());
  EXPECT_LT((*make_codec("png:9"))->encode(image)->size(),
            (*make_codec("png:0"))->encode(image)->size());
}

TEST(Codecs, RefuseTextsThatMeanNothing) {
  EXPECT_FAILS(make_codec("gif"), StatusCode::kInvalidArgument,
               "unknown codec 'gif', needs one of: png, zstd, rowpred");
  EXPECT_FAILS(make_codec("jpeg:101"), StatusCode::kInvalidArgument,
               "quality is 101, needs 1 to 100");
  EXPECT_FAILS(make_codec("png:quality=3"), StatusCode::kInvalidArgument,
               "no option 'quality', needs one of 'level'");
  EXPECT_FAILS(make_codec("rowpred:3"), StatusCode::kInvalidArgument, "no option '3', needs none");
}

TEST(Png, RefusesAHeaderThatAnnouncesMoreThanThereIsWithoutAllocatingIt) {
  RandomValues random(16);
  auto bytes = *find_codec("png")->encode(random_array(ElementType::kUInt8, {9, 8, 1}, random));
  const uint32_t side = __builtin_bswap32(30'000);
  std::memcpy(bytes.data() + 16, &side, sizeof(side));
  std::memcpy(bytes.data() + 20, &side, sizeof(side));
  rusage before{}, after{};
  ::getrusage(RUSAGE_SELF, &before);
  for (const Shape& shape : {Shape{9, 8, 1}, Shape{30'000, 30'000, 1}})
    EXPECT_FAILS(find_codec("png")->decode(bytes, ElementType::kUInt8, shape),
                 StatusCode::kDataLoss, "png");
  ::getrusage(RUSAGE_SELF, &after);
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 100'000) << "kilobytes";
}

TEST(Rowpred, TakesLessThanPngOfASmoothImage) {
  const NdArray image = smooth_image(200, 300, 3);
  EXPECT_LT(find_codec("rowpred")->encode(image)->size(), find_codec("png")->encode(image)->size());
}

TEST(Rowpred, TakesAlmostNothingOfAnEmptyDepthImage) {
  const auto depth = NdArray::take<float>({480, 640, 1}, std::vector<float>(480 * 640, 1.5f));
  EXPECT_LT(find_codec("rowpred")->encode(depth)->size(), 1000u);
}

}  // namespace
}  // namespace engram::ltm
