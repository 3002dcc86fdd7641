// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/row_prediction.h"

#include <cstring>

#include "tests/ltm/codec/test_images.h"
#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

using Bytes = std::vector<std::byte>;

Bytes random_bytes(size_t size, RandomValues& random) {
  Bytes bytes(size);
  // Runs and extremes beside noise.
  for (std::byte& byte : bytes)
    byte = random.below(3) == 0 ? std::byte{255} : static_cast<std::byte>(random.bits());
  return bytes;
}

/// The definition, number by number, for bytes.
Bytes expected_residuals(const Bytes& image, const ImageSize& size, bool colour_differences) {
  const auto number = [&](size_t y, size_t x, size_t plane) {
    size_t channel = plane;
    if (colour_differences && plane < 2) channel = 1 - plane;
    const auto at = [&](size_t c) {
      return std::to_integer<int>(image[(y * size.width + x) * size.channels + c]);
    };
    const int plain = at(channel);
    return static_cast<uint8_t>(colour_differences && (plane == 1 || plane == 2) ? plain - at(1)
                                                                                 : plain);
  };
  Bytes out;
  for (size_t plane = 0; plane < size.channels; ++plane)
    for (size_t y = 0; y < size.height; ++y)
      for (size_t x = 0; x < size.width; ++x) {
        const int upper = y > 0 ? number(y - 1, x, plane) : 0;
        const int corner = y > 0 && x > 0 ? number(y - 1, x - 1, plane) : upper;
        const int left = x > 0 ? number(y, x - 1, plane) : upper;
        int guess = left + upper - corner;
        if (corner >= std::max(left, upper)) guess = std::min(left, upper);
        if (corner <= std::min(left, upper)) guess = std::max(left, upper);
        out.push_back(static_cast<std::byte>(number(y, x, plane) - guess));
      }
  return out;
}

TEST(RowPrediction, IsTheMedianEdgeDetector) {
  RandomValues random(31);
  for (const size_t channels : {1, 2, 3, 4})
    for (const bool differences : {false, true}) {
      if (differences && channels < 3) continue;
      const ImageSize size{.height = 19, .width = 45, .channels = channels};
      const Bytes image = random_bytes(size.bytes(), random);
      Bytes residuals(image.size());
      predict_rows(image, size, differences, residuals);
      EXPECT_EQ(residuals, expected_residuals(image, size, differences));
    }
}

void expect_same_and_inverse(const ImageSize& size, bool differences, const Bytes& image) {
  Bytes wide(image.size()), portable(image.size()), back(image.size());
  predict_rows(image, size, differences, wide);
  predict_rows(image, size, differences, portable, Vectors::kPortable);
  EXPECT_EQ(wide, portable);
  for (const Vectors vectors : {Vectors::kWidest, Vectors::kPortable}) {
    restore_rows(wide, size, differences, back, vectors);
    EXPECT_EQ(back, image) << size.height << " x " << size.width << " x " << size.channels
                           << " numbers of " << size.element_bytes << " bytes";
  }
}

TEST(RowPrediction, IsTheSameOnEveryProcessorAndInverts) {
  RandomValues random(32);
  for (const size_t element_bytes : {1, 2, 4})
    for (const size_t channels : {1, 2, 3, 4})
      // Bytes are restored in bands of sixteen rows and squares of sixteen columns.
      for (const size_t height : {1, 5, 16, 35})
        for (const size_t width : {1, 2, 3, 15, 16, 17, 64, 133})
          for (const bool is_float : {false, true}) {
            if (is_float && element_bytes != 4) continue;
            const ImageSize size{height, width, channels, element_bytes, is_float};
            const bool differences = channels >= 3 && width % 2 == 1;
            expect_same_and_inverse(size, differences, random_bytes(size.bytes(), random));
          }
}

TEST(RowPrediction, HasSmallNumbersForASmoothImage) {
  const idf::NdArray image = smooth_image(64, 64, 3);
  const ImageSize size{.height = 64, .width = 64, .channels = 3};
  Bytes residuals(size.bytes());
  predict_rows(image.bytes(), size, false, residuals);
  size_t large = 0;
  for (const std::byte residual : residuals)
    large += std::abs(static_cast<int8_t>(residual)) > 4 ? 1 : 0;
  EXPECT_LT(large, residuals.size() / 50);
}

TEST(RowPrediction, PrefersColourDifferencesWhereChannelsGoTogether) {
  RandomValues random(33);
  const ImageSize size{.height = 40, .width = 40, .channels = 3};
  Bytes grey(size.bytes());
  for (size_t i = 0; i < grey.size(); i += 3)
    grey[i] = grey[i + 1] = grey[i + 2] = static_cast<std::byte>(random.below(60));
  EXPECT_TRUE(prefers_colour_differences(grey, size));
  // Noise in green alone would be copied to the others.
  Bytes green(size.bytes());
  for (size_t i = 1; i < green.size(); i += 3) green[i] = static_cast<std::byte>(random.below(60));
  EXPECT_FALSE(prefers_colour_differences(green, size));
  EXPECT_FALSE(prefers_colour_differences(Bytes(1600), {.height = 40, .width = 40}));
}

}  // namespace
}  // namespace engram::ltm
