// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "augmentation/image_changes.h"
#include "augmentation/light.h"

namespace engram::augmentation {

namespace {

constexpr int64_t kMaxTemperatureDrawn = 100;
/// The gain of red and the loss of blue at 100 percent. Unit: thousandths.
constexpr int64_t kMaxGain = 250;
constexpr std::array<Parameter, 1> kTemperatureParameters{
    {{"percent", -100, 100, "warmer where positive: red gains and blue loses a quarter at 100"}}};

class Temperature final : public ImageChange {
 public:
  [[nodiscard]] std::string_view name() const override { return "temperature"; }
  [[nodiscard]] std::string_view about() const override {
    return "warmer or colder light; nothing on grey images";
  }
  [[nodiscard]] std::span<const Parameter> parameters() const override {
    return kTemperatureParameters;
  }

  [[nodiscard]] Parameters draw(Random& random, int strength_percent) const override {
    return {{"percent", draw_around_zero(random, kMaxTemperatureDrawn, strength_percent)}};
  }

  void apply(const Parameters& parameters, SceneImages& images) const override {
    const int64_t gain = parameters.at("percent") * kMaxGain;
    map_levels(images, [=](int channel, int level) {
      const int64_t sign = 1 - channel;  // 1 for red, 0 for green, -1 for blue.
      return divided(level * (100'000 + sign * gain), 100'000);
    });
  }
};

}  // namespace

std::unique_ptr<const ImageChange> make_temperature() {
  return std::make_unique<Temperature>();
}

}  // namespace engram::augmentation
