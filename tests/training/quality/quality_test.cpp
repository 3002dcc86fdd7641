// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "training/quality/bd_rate.h"
#include "training/quality/psnr.h"
#include "training/quality/ssim.h"

namespace engram::training {
namespace {

idf::NdArray image_of(const std::function<int(int y, int x, int c)>& grey) {
  std::vector<uint8_t> pixels;
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 24; ++x)
      for (int c = 0; c < 3; ++c) pixels.push_back(static_cast<uint8_t>(grey(y, x, c)));
  return idf::NdArray::take<uint8_t>({20, 24, 3}, std::move(pixels));
}

int rough(int y, int x, int c) {
  return (7 * x * x + 13 * y * (c + 1) + x * y) % 256;
}
int noisy(int y, int x, int c) {
  return std::clamp(rough(y, x, c) + (x * 5 + y * 3 + c) % 23 - 11, 0, 255);
}
int smooth(int y, int x, int c) {
  return 40 + 5 * x + 3 * y + 20 * c;
}
int stepped(int y, int x, int c) {
  return smooth(y, x, c) / 16 * 16;
}

// The values are those of a direct implementation in NumPy: weighted sums over each window.
TEST(Ssim, IsWhatAnIndependentImplementationFinds) {
  EXPECT_NEAR(*ssim(image_of(rough), image_of(noisy)), 0.9959019068576145, 1e-9);
  EXPECT_NEAR(*ssim(image_of(smooth), image_of(stepped)), 0.9072393230433354, 1e-9);
  EXPECT_NEAR(*ssim(image_of(rough), image_of(smooth)), 0.012635181363268546, 1e-9);
}

TEST(Ssim, IsOneForEqualImages) {
  EXPECT_NEAR(*ssim(image_of(rough), image_of(rough)), 1.0, 1e-12);
}

TEST(Ssim, RefusesImagesThatAreSmallOrDiffer) {
  const auto small = idf::NdArray::take<uint8_t>({10, 20, 1}, std::vector<uint8_t>(200));
  EXPECT_EQ(ssim(small, small).status().code(), StatusCode::kInvalidArgument);
  EXPECT_FALSE(ssim(image_of(rough), small).ok());
}

TEST(ImageMse, IsTheMeanOfSquares) {
  const auto brighter = image_of([](int y, int x, int c) { return smooth(y, x, c) + 3; });
  EXPECT_DOUBLE_EQ(*image_mse(image_of(smooth), brighter), 9.0);
  const auto small = idf::NdArray::take<uint8_t>({10, 20, 1}, std::vector<uint8_t>(200));
  EXPECT_FALSE(image_mse(image_of(smooth), small).ok());
}

TEST(MovingMse, LooksOnlyAtWhatChanged) {
  const auto before = image_of([](int, int, int) { return 100; });
  const auto now = image_of([](int y, int x, int) { return y == 3 && x < 6 ? 140 : 105; });
  const auto other = image_of([](int y, int x, int) { return y == 3 && x < 6 ? 136 : 0; });
  EXPECT_DOUBLE_EQ(*moving_mse(before, now, other), 16.0);
  EXPECT_TRUE(std::isnan(*moving_mse(before, before, other)));
}

TEST(BitsPerPixel, CountsEightPerByte) {
  EXPECT_DOUBLE_EQ(bits_per_pixel(2048, 128, 128), 1.0);
}

const std::vector<RatePoint> kReference{{258, 45.1}, {111, 42.8}, {61, 40.1}, {40, 38.0}};

TEST(BdRate, IsTheShareOfBytesThatIsSaved) {
  std::vector<RatePoint> half = kReference;
  for (RatePoint& point : half) point.bytes /= 2;
  EXPECT_NEAR(*bd_rate(kReference, half), -0.5, 1e-12);
  EXPECT_NEAR(*bd_rate(half, kReference), 1.0, 1e-12);
  EXPECT_NEAR(*bd_rate(kReference, kReference), 0.0, 1e-12);
}

// The value is that of a numeric integration in NumPy over 200,000 places.
TEST(BdRate, IsWhatAnIndependentImplementationFinds) {
  const std::vector<RatePoint> other{{30, 37.5}, {200, 44.9}, {90, 43.0}, {50, 40.5}};
  EXPECT_NEAR(*bd_rate(kReference, other), -0.2260306424819245, 1e-7);
}

TEST(BdRate, RefusesCurvesThatShareNoQuality) {
  const std::vector<RatePoint> worse{{10, 30.0}, {20, 33.0}}, single{{10, 40.0}};
  EXPECT_EQ(bd_rate(kReference, worse).status().code(), StatusCode::kInvalidArgument);
  EXPECT_FALSE(bd_rate(kReference, single).ok());
  EXPECT_FALSE(bd_rate(kReference, std::vector<RatePoint>{{10, 40.0}, {12, 40.0}}).ok());
  EXPECT_FALSE(bd_rate(kReference, std::vector<RatePoint>{{0, 40.0}, {12, 41.0}}).ok());
}

}  // namespace
}  // namespace engram::training
