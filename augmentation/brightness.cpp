// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "augmentation/image_changes.h"
#include "augmentation/light.h"

namespace engram::augmentation {

namespace {

constexpr int64_t kMaxBrightnessDrawn = 64;
constexpr std::array<Parameter, 1> kBrightnessParameters{
    {{"levels", -255, 255, "grey levels added"}}};

class Brightness final : public ImageChange {
 public:
  [[nodiscard]] std::string_view name() const override { return "brightness"; }
  [[nodiscard]] std::string_view about() const override { return "lighter or darker"; }
  [[nodiscard]] std::span<const Parameter> parameters() const override {
    return kBrightnessParameters;
  }

  [[nodiscard]] Parameters draw(Random& random, int strength_percent) const override {
    return {{"levels", draw_around_zero(random, kMaxBrightnessDrawn, strength_percent)}};
  }

  void apply(const Parameters& parameters, SceneImages& images) const override {
    const int64_t levels = parameters.at("levels");
    map_levels(images, [=](int, int level) { return level + levels; });
  }
};

}  // namespace

std::unique_ptr<const ImageChange> make_brightness() {
  return std::make_unique<Brightness>();
}

}  // namespace engram::augmentation
