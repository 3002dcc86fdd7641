// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/background_coder.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "tests/ltm/expect_status.h"

namespace engram::encoders {
namespace {

constexpr LatentGrid kShape{3, 24, 40};

/// Smooth ground with an edge; noise that all channels share, and some of their own.
std::vector<uint8_t> some_scenes(size_t scenes, int shared, int own, unsigned seed) {
  std::mt19937 random(seed);
  const auto noise = [&](int max) {
    return max == 0 ? 0 : static_cast<int>(random() % static_cast<unsigned>(2 * max + 1)) - max;
  };
  std::vector<int> common(static_cast<size_t>(kShape.height * kShape.width));
  std::vector<uint8_t> pixels;
  for (size_t scene = 0; scene < scenes; ++scene) {
    for (int& each : common) each = noise(shared);
    for (int c = 0; c < kShape.channels; ++c)
      for (int y = 0; y < kShape.height; ++y)
        for (int x = 0; x < kShape.width; ++x)
          pixels.push_back(static_cast<uint8_t>(60 + 2 * x + y + 20 * c + (x > 25 ? 40 : 0) +
                                                common[static_cast<size_t>(y * kShape.width + x)] +
                                                noise(own)));
  }
  return pixels;
}

TEST(BackgroundCoder, GivesBackEveryGreyLevel) {
  std::mt19937 random(1);
  std::vector<uint8_t> noise(2 * kShape.count());
  for (uint8_t& each : noise) each = static_cast<uint8_t>(random());
  std::vector<uint8_t> stripes(kShape.count());
  for (size_t i = 0; i < stripes.size(); ++i) stripes[i] = i % 2 == 0 ? 0 : 255;
  for (const auto& pixels : {some_scenes(3, 2, 1, 2), noise, stripes, std::vector<uint8_t>()}) {
    const auto bytes = encode_backgrounds(pixels, kShape);
    const auto read = decode_backgrounds(bytes, pixels.size() / kShape.count(), kShape, "ground");
    ASSERT_OK(read);
    EXPECT_EQ(*read, pixels);
  }
}

TEST(BackgroundCoder, TakesWhatCannotBeForetold) {
  const double pixels = 8 * static_cast<double>(kShape.count());
  const auto bits = [&](int shared, int own) {
    return 8 *
           static_cast<double>(encode_backgrounds(some_scenes(8, shared, own, 3), kShape).size()) /
           pixels;
  };
  EXPECT_LT(bits(0, 0), 0.2) << "the ground alone";
  EXPECT_LT(bits(0, 2), std::log2(5.0) + 1.2) << "noise of five levels";
  EXPECT_LT(bits(8, 0), 0.6 * bits(0, 8)) << "what channels share is told once";
}

TEST(BackgroundCoder, FindsDamageAndAnotherShape) {
  const auto pixels = some_scenes(1, 1, 0, 4);
  const auto bytes = encode_backgrounds(pixels, kShape);
  for (size_t byte = 0; byte < bytes.size(); byte += 7) {
    auto damaged = bytes;
    damaged[byte] ^= std::byte{1};
    EXPECT_FAILS(decode_backgrounds(damaged, 1, kShape, "ground"), StatusCode::kDataLoss, "ground");
  }
  EXPECT_FALSE(decode_backgrounds(bytes, 1, {3, 40, 24}, "turned").ok());
  EXPECT_FALSE(decode_backgrounds(bytes, 2, kShape, "twice").ok());
}

}  // namespace
}  // namespace engram::encoders
