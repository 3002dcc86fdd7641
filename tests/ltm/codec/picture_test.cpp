// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/picture.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/ltm/random_values.h"

namespace engram::ltm {
namespace {

/// The arithmetic of docs/codecs.md, pixel by pixel: stored videos depend on each bit of it.
void expect_colours(const AVFrame& picture, const idf::NdArray& image) {
  const auto at = [&](int plane, int64_t y, int64_t x) {
    return static_cast<int>(
        reinterpret_cast<const uint16_t*>(picture.data[plane] + y * picture.linesize[plane])[x] &
        1023);
  };
  const auto rgb = image.values<uint8_t>();
  size_t next = 0;
  for (int64_t y = 0; y < image.shape()[0]; ++y)
    for (int64_t x = 0; x < image.shape()[1]; ++x) {
      const int luma = 261376 * at(0, y, x) + (1 << 19);
      const int blue = at(1, y, x) - 512, red = at(2, y, x) - 512;
      for (const int value :
           {luma + 366450 * red, luma - 89949 * blue - 186658 * red, luma + 463159 * blue})
        ASSERT_EQ(rgb[next++], std::clamp(value >> 20, 0, 255)) << x << ", " << y;
    }
}

TEST(Picture, OfTenBitsGivesTheSameColoursAtEveryWidth) {
  RandomValues random(5);
  for (const int64_t width : {1, 17, 127, 128, 129, 300}) {
    const idf::Shape shape{3, width, 3};
    const auto picture = make_picture(PictureLayout::kYcc444Deep, shape);
    ASSERT_TRUE(picture.ok());
    // Of damaged streams, too: numbers of more than ten bits.
    for (int plane = 0; plane < 3; ++plane)
      for (int64_t y = 0; y < shape[0]; ++y)
        for (int64_t x = 0; x < width; ++x)
          reinterpret_cast<uint16_t*>((*picture)->data[plane] +
                                      y * (*picture)->linesize[plane])[x] =
              static_cast<uint16_t>(random.below(1 << 16));
    const auto image =
        read_picture(**picture, PictureLayout::kYcc444Deep, idf::ElementType::kUInt8, shape);
    ASSERT_TRUE(image.ok());
    expect_colours(**picture, *image);
  }
}

}  // namespace
}  // namespace engram::ltm
