// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/shown_image.h"

#include <cmath>

#include "ltm/codec/image_file.h"
#include "ltm/core/buffer.h"
#include "tests/ltm/expect_status.h"

namespace engram::reports {
namespace {

idf::NdArray grey(uint8_t level) {
  return idf::NdArray::take<uint8_t>({8, 8, 1}, std::vector<uint8_t>(64, level));
}

TEST(ShownImage, ScalesDepthToGreyAndTellsTheRange) {
  std::vector<float> depth(64, 1.0f);
  depth[0] = 0;  // Not known.
  depth[1] = 3;
  depth[2] = std::nanf("");
  depth[3] = 2;
  const ShownImage shown = shown_image(idf::NdArray::take<float>({8, 8, 1}, depth));
  EXPECT_EQ(shown.range, (std::pair<double, double>(1, 3)));
  const auto levels = shown.pixels.values<uint8_t>();
  EXPECT_EQ(levels[0], 0);
  EXPECT_EQ(levels[1], 255);
  EXPECT_EQ(levels[2], 0);
  EXPECT_EQ(levels[3], 128);
  EXPECT_EQ(levels[4], 0);
}

TEST(ShownImage, OfOneDepthIsBlack) {
  const ShownImage shown =
      shown_image(idf::NdArray::take<uint16_t>({8, 8, 1}, std::vector<uint16_t>(64, 700)));
  EXPECT_EQ(shown.range, (std::pair<double, double>(700, 700)));
  EXPECT_EQ(shown.pixels, grey(0));
}

TEST(ErrorMap, IsBrightenedAndSaysHowMuch) {
  const auto map = error_map(grey(100), grey(90));
  ASSERT_OK(map);
  EXPECT_EQ(map->gain, 16);
  EXPECT_EQ(map->pixels, grey(160));
  EXPECT_EQ(error_map(grey(0), grey(255))->gain, 1);
  EXPECT_EQ(error_map(grey(7), grey(7))->pixels, grey(0));
  EXPECT_FAILS(error_map(grey(1), idf::NdArray::take<uint8_t>({8, 9, 1}, std::vector<uint8_t>(72))),
               StatusCode::kInvalidArgument, "two equal images");
}

TEST(EncodedImage, IsWhatItIsCalled) {
  for (const char* as : {"png", "jpeg"}) {
    const auto file = encoded_image(grey(80), as, 92);
    ASSERT_OK(file);
    EXPECT_EQ(ltm::announced_image(as_bytes(*file))->codec, as);
  }
  EXPECT_EQ(*ltm::decode_image_file(as_bytes(*encoded_image(grey(80), "png", 1))), grey(80));
}

}  // namespace
}  // namespace engram::reports
