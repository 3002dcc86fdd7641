// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "augmentation/image_changes.h"
#include "augmentation/light.h"

namespace engram::augmentation {

namespace {

constexpr int64_t kMaxNoiseDrawn = 120;
constexpr std::array<Parameter, 2> kNoiseParameters{
    {{"sigma_tenths", 0, 1000, "standard deviation, tenths of a grey level"},
     {"seed", 0, kMaxSeed, "of the noise"}}};

/// The sum of four random bytes is nearly Gaussian; this is its mean.
constexpr int64_t kMean = 510;
/// The standard deviation of the sum. Unit: hundredths.
constexpr int64_t kDeviation = 14780;

int64_t noise_of(uint64_t four_bytes) {
  int64_t sum = -kMean;
  for (int i = 0; i < 4; ++i) sum += static_cast<int64_t>((four_bytes >> (8 * i)) & 0xff);
  return sum;
}

void add_noise(cv::Mat& pixels, uint64_t seed, int64_t sigma_tenths) {
  uint8_t* levels = pixels.data;
  const size_t count = pixels.total() * pixels.elemSize();
  for (size_t i = 0; i < count; ++i) {
    // Each random number gives two noise values.
    const uint64_t bits = random_at(seed, i / 2) >> (i % 2 == 0 ? 0 : 32);
    levels[i] = to_grey_level(levels[i] + divided(noise_of(bits) * sigma_tenths * 10, kDeviation));
  }
}

class Noise final : public ImageChange {
 public:
  [[nodiscard]] std::string_view name() const override { return "noise"; }
  [[nodiscard]] std::string_view about() const override { return "a sensor's noise"; }
  [[nodiscard]] std::span<const Parameter> parameters() const override { return kNoiseParameters; }

  [[nodiscard]] Parameters draw(Random& random, int strength_percent) const override {
    return {{"sigma_tenths", random.between(0, kMaxNoiseDrawn * strength_percent / 100)},
            {"seed", random.between(0, kMaxSeed)}};
  }

  void apply(const Parameters& parameters, SceneImages& images) const override {
    const auto seed = static_cast<uint64_t>(parameters.at("seed"));
    uint64_t number = 0;
    for (SceneImage& image : images.images)
      if (image.role == PixelRole::kLight)
        add_noise(image.pixels, random_at(seed, number++), parameters.at("sigma_tenths"));
  }
};

}  // namespace

std::unique_ptr<const ImageChange> make_noise() {
  return std::make_unique<Noise>();
}

}  // namespace engram::augmentation
