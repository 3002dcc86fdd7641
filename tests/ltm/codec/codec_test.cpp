// SPDX-License-Identifier: Apache-2.0
// The suite that every codec passes: ltm/codec/codec.h.
#include "ltm/codec/codec.h"

#include <sys/resource.h>

#include <algorithm>
#include <cstring>

#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"

namespace engram::ltm {
namespace {

using idf::ElementType;
using idf::NdArray;
using idf::Shape;

NdArray random_array(ElementType type, const Shape& shape, RandomValues& random) {
  std::vector<uint64_t> words((*idf::size_bytes(type, shape) + 7) / 8);
  for (uint64_t& word : words) word = random.bits();
  const Buffer buffer = Buffer::take(std::move(words));
  return *NdArray::create(type, shape, buffer.slice(0, *idf::size_bytes(type, shape)));
}

class CodecTest : public ::testing::TestWithParam<const Codec*> {
 protected:
  const Codec& codec() { return *GetParam(); }

  void expect_round_trip(const NdArray& array) {
    const Buffer before = Buffer::copy(array.bytes());
    const auto bytes = codec().encode(array);
    ASSERT_OK(bytes);
    EXPECT_TRUE(std::ranges::equal(array.bytes(), before.bytes())) << "encoding changed the array";
    const auto decoded = codec().decode(*bytes, array.type(), array.shape());
    ASSERT_OK(decoded);
    EXPECT_EQ(decoded->type(), array.type());
    EXPECT_EQ(decoded->shape(), array.shape());
    if (codec().is_lossless()) {
      EXPECT_EQ(*decoded, array);
    }
    EXPECT_EQ(*codec().encode(array), *bytes) << "the same array gives other bytes";
  }
};

TEST_P(CodecTest, GivesBackWhatItAccepts) {
  RandomValues random(13);
  for (int code = 1; code <= 10; ++code)
    for (const Shape& shape :
         {Shape{}, Shape{1}, Shape{0}, Shape{3, 0, 2}, Shape{5, 7}, Shape{1, 1, 1}, Shape{9, 8, 1},
          Shape{13, 11, 3}, Shape{4, 3, 4}, Shape{2, 3, 4, 5}}) {
      const ElementType type = *idf::element_type_from_code(static_cast<uint8_t>(code));
      const NdArray array = random_array(type, shape, random);
      if (codec().accepts(type, shape))
        expect_round_trip(array);
      else
        EXPECT_FAILS(codec().encode(array), StatusCode::kInvalidArgument, idf::to_string(shape));
    }
}

TEST_P(CodecTest, GivesBackALargeImage) {
  std::vector<uint8_t> pixels(1080 * 1920 * 3);
  for (size_t i = 0; i < pixels.size(); ++i)
    pixels[i] = static_cast<uint8_t>(i / 5760 + i % 3 * 50);
  expect_round_trip(NdArray::take({1080, 1920, 3}, std::move(pixels)));
}

TEST_P(CodecTest, RefusesBytesOfAnotherTypeOrShape) {
  RandomValues random(14);
  const NdArray array = random_array(ElementType::kUInt8, {12, 10, 1}, random);
  const auto bytes = *codec().encode(array);
  for (const Shape& shape : {Shape{10, 12, 1}, Shape{12, 10, 3}, Shape{24, 10, 1}, Shape{},
                             Shape{0}, Shape{-1, 10, 1}, Shape{INT64_MAX, INT64_MAX, 1}}) {
    // A codec that knows no shapes cannot tell 12 x 10 from 10 x 12.
    if (codec().name() == "zstd" && shape == Shape{10, 12, 1}) continue;
    EXPECT_FAILS(codec().decode(bytes, array.type(), shape), StatusCode::kDataLoss, "");
  }
  EXPECT_FAILS(codec().decode(bytes, ElementType::kUInt16, array.shape()), StatusCode::kDataLoss,
               "");
  EXPECT_FAILS(codec().decode({}, array.type(), array.shape()), StatusCode::kDataLoss, "");
}

TEST_P(CodecTest, SurvivesEveryTruncationAndRandomFlips) {
  RandomValues random(15);
  const NdArray array = random_array(ElementType::kUInt8, {9, 8, 3}, random);
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
  for (int i = 0; i < 3000; ++i) {
    auto damaged = bytes;
    for (size_t flips = 1 + random.below(3); flips > 0; --flips)
      damaged[random.below(damaged.size())] = static_cast<std::byte>(random.bits());
    expect_same_size_or_error(damaged);
  }
}

INSTANTIATE_TEST_SUITE_P(All, CodecTest,
                         ::testing::ValuesIn(all_codecs().begin(), all_codecs().end()),
                         [](const auto& chosen) { return std::string(chosen.param->name()); });

TEST(Codecs, AreFoundByTheirName) {
  for (const Codec* codec : all_codecs()) EXPECT_EQ(find_codec(codec->name()), codec);
  EXPECT_EQ(find_codec("gif"), nullptr);
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

}  // namespace
}  // namespace engram::ltm
