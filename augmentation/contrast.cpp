// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "augmentation/image_changes.h"
#include "augmentation/light.h"

namespace engram::augmentation {

namespace {

constexpr int64_t kMaxContrastDrawn = 50;
constexpr int64_t kMiddle = 128;
constexpr std::array<Parameter, 1> kContrastParameters{
    {{"percent", 0, 400, "distance of levels from the middle grey, 100: as it was"}}};

class Contrast final : public ImageChange {
 public:
  [[nodiscard]] std::string_view name() const override { return "contrast"; }
  [[nodiscard]] std::string_view about() const override { return "more or less contrast"; }
  [[nodiscard]] std::span<const Parameter> parameters() const override {
    return kContrastParameters;
  }

  [[nodiscard]] Parameters draw(Random& random, int strength_percent) const override {
    return {{"percent", 100 + draw_around_zero(random, kMaxContrastDrawn, strength_percent)}};
  }

  void apply(const Parameters& parameters, SceneImages& images) const override {
    const int64_t percent = parameters.at("percent");
    map_levels(images,
               [=](int, int level) { return kMiddle + divided((level - kMiddle) * percent, 100); });
  }
};

}  // namespace

std::unique_ptr<const ImageChange> make_contrast() {
  return std::make_unique<Contrast>();
}

}  // namespace engram::augmentation
