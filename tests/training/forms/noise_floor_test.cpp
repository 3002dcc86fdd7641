// SPDX-License-Identifier: Apache-2.0
#include "training/forms/noise_floor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace engram::training {
namespace {

constexpr int kNoiseSide = 96;

using Scene = std::function<double(int x, int y)>;

/// A scene as a camera with noise sees it.
idf::NdArray seen(const Scene& scene, double deviation, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, deviation > 0 ? deviation : 1);
  std::vector<uint8_t> pixels;
  for (int y = 0; y < kNoiseSide; ++y)
    for (int x = 0; x < kNoiseSide; ++x)
      for (int c = 0; c < 3; ++c) {
        const double value = scene(x, y) + 5 * c + (deviation > 0 ? noise(random) : 0);
        pixels.push_back(static_cast<uint8_t>(std::clamp(std::round(value), 0.0, 255.0)));
      }
  return idf::NdArray::take<uint8_t>({kNoiseSide, kNoiseSide, 3}, std::move(pixels));
}

double shading(int x, int y) {
  return 60 + 0.7 * x + 0.5 * y;
}

double texture(int x, int y) {
  return 120 + 35 * std::sin(2.1 * x + 0.3 * y) * std::cos(1.7 * y);
}

double measured(const Scene& first, const Scene& second, double deviation) {
  NoiseFloor floor;
  for (unsigned pair = 0; pair < 4; ++pair)
    EXPECT_TRUE(
        floor.add(seen(first, deviation, 2 * pair + 1), seen(second, deviation, 2 * pair + 2))
            .ok());
  EXPECT_EQ(floor.images(), 4);
  return *floor.deviation();
}

TEST(NoiseFloor, FindsTheDeviationOfNoise) {
  for (const double deviation : {1.0, 2.0, 4.0, 6.0, 10.0})
    EXPECT_NEAR(measured(shading, shading, deviation), deviation, 0.06 * deviation);
}

TEST(NoiseFloor, TakesNoTextureForNoiseWhereNothingMoves) {
  for (const double deviation : {2.0, 4.0, 6.0})
    EXPECT_NEAR(measured(texture, texture, deviation), deviation, 0.06 * deviation);
}

TEST(NoiseFloor, TakesNoMotionForNoiseWhereNothingIsTextured) {
  const Scene moved = [](int x, int y) { return shading(x + 20, y) - 10; };
  for (const double deviation : {2.0, 4.0, 6.0})
    EXPECT_NEAR(measured(shading, moved, deviation), deviation, 0.06 * deviation);
}

TEST(NoiseFloor, FindsNextToNoneInWhatACodecSmoothed) {
  EXPECT_LT(measured(shading, shading, 0), 0.5);
  EXPECT_LT(measured(texture, texture, 0), 0.5);
}

TEST(NoiseFloor, LooksPastPixelsThatAreCutOff) {
  const Scene bright = [](int x, int y) { return x < kNoiseSide / 2 ? 400.0 : shading(x, y); };
  EXPECT_NEAR(measured(bright, bright, 4), 4, 0.3);
  EXPECT_EQ(measured([](int, int) { return 400.0; }, [](int, int) { return 400.0; }, 4), 0);
}

TEST(NoiseFloor, LeavesDepthOut) {
  const auto depth =
      idf::NdArray::take<uint16_t>({8, 8, 1}, std::vector<uint16_t>(64, uint16_t{700}));
  NoiseFloor floor;
  EXPECT_TRUE(floor.add(depth, depth).ok());
  EXPECT_EQ(floor.images(), 0);
  EXPECT_FALSE(floor.deviation().has_value());
}

TEST(NoiseFloor, RefusesImagesThatDiffer) {
  const auto image = seen(shading, 2, 1);
  const auto other = idf::NdArray::take<uint8_t>({8, 8, 3}, std::vector<uint8_t>(192));
  NoiseFloor floor;
  EXPECT_EQ(floor.add(image, other).code(), StatusCode::kInvalidArgument);
}

TEST(NoiseFloor, GivesABoundWithinItsEnds) {
  EXPECT_DOUBLE_EQ(bound_of_noise(2), 40);  // 42.1 dB.
  EXPECT_NEAR(bound_of_noise(4), 36.1, 0.02);
  EXPECT_NEAR(bound_of_noise(6), 32.6, 0.05);
  EXPECT_DOUBLE_EQ(bound_of_noise(20), 30);
  EXPECT_DOUBLE_EQ(bound_of_noise(0), 40);
}

}  // namespace
}  // namespace engram::training
