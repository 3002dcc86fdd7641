// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/medium_decoder.h"

#include "ltm/codec/codec.h"
#include "ltm/codec/group_codec.h"
#include "tests/ltm/codec/test_images.h"
#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

constexpr uint32_t kCount = 6;

idf::NdArray picture(uint32_t index) {
  return smooth_image(24, 32, 3, static_cast<int>(index) * 5);
}

/// The images of one group as media.
std::vector<PackedMedium> group(const std::string& codec) {
  std::vector<idf::NdArray> images;
  for (uint32_t i = 0; i < kCount; ++i) images.push_back(picture(i));
  const Buffer bytes = Buffer::take(*find_group_codec(codec)->encode(images));
  std::vector<PackedMedium> media;
  for (uint32_t i = 0; i < kCount; ++i)
    media.push_back(
        {"image", codec, idf::ElementType::kUInt8, {24, 32, 3}, bytes, GroupPlace{i, kCount}});
  return media;
}

TEST(MediumDecoder, GivesEachImageOfAGroup) {
  MediumDecoder decoder;
  const auto first = group("ffv1");
  const auto second = group("h264");
  for (const uint32_t i : {3u, 0u, 5u, 3u}) {
    EXPECT_EQ(*decoder.decode(first[i]), picture(i));
    EXPECT_GT(psnr_db(*decoder.decode(second[i]), picture(i)), 30);
  }
}

TEST(MediumDecoder, DecodesAGroupOnce) {
  MediumDecoder decoder;
  const auto media = group("ffv1");
  const auto first = decoder.decode(media[2]);
  const auto again = decoder.decode(media[2]);
  EXPECT_EQ(first->bytes().data(), again->bytes().data());
  MediumDecoder other;
  EXPECT_NE(other.decode(media[2])->bytes().data(), first->bytes().data());
}

TEST(MediumDecoder, RefusesPlacesThatAGroupDoesNotHave) {
  MediumDecoder decoder;
  PackedMedium medium = group("ffv1")[0];
  medium.group = {6, 6};
  EXPECT_FAILS(decoder.decode(medium), StatusCode::kDataLoss, "image 6 of a group of 6");
  medium.group = {0, 0};
  EXPECT_FAILS(decoder.decode(medium), StatusCode::kDataLoss, "group of 0");
  medium.group = {0, 7};
  EXPECT_FAILS(decoder.decode(medium), StatusCode::kDataLoss, "");
  medium.group = {0, UINT32_MAX};
  EXPECT_FAILS(decoder.decode(medium), StatusCode::kDataLoss, "bytes fit");
  medium.group = {0, kCount};
  medium.shape = {int64_t{1} << 31, int64_t{1} << 31, 3};
  EXPECT_FAILS(decoder.decode(medium), StatusCode::kDataLoss, "bytes fit");
}

TEST(MediumDecoder, RefusesCodecsThatThereAreNot) {
  MediumDecoder decoder;
  PackedMedium medium = group("ffv1")[0];
  medium.codec = "png";
  EXPECT_FAILS(decoder.decode(medium), StatusCode::kDataLoss, "group codec 'png'");
  medium.codec = "h264";
  EXPECT_FAILS(decoder.decode(medium), StatusCode::kDataLoss, "");
  medium.group.reset();
  EXPECT_FAILS(decoder.decode(medium), StatusCode::kDataLoss, "unknown codec 'h264'");
}

TEST(MediumDecoder, MakesMediaAloneWithoutFurtherLoss) {
  MediumDecoder decoder;
  const auto media = group("h264");
  const auto alone = pack_alone(media[4], decoder);
  ASSERT_OK(alone);
  EXPECT_EQ(alone->codec, "rowpred");
  EXPECT_FALSE(alone->group);
  EXPECT_EQ(*decoder.decode(*alone), *decoder.decode(media[4]));
}

}  // namespace
}  // namespace engram::ltm
