// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "augmentation/image_changes.h"
#include "augmentation/move.h"

namespace engram::augmentation {

namespace {

constexpr int64_t kMaxRotateDrawn = 10'000;
constexpr std::array<Parameter, 1> kRotateParameters{
    {{"millidegrees", -45'000, 45'000, "clockwise as seen, about the middle"}}};

class Rotate final : public ImageChange {
 public:
  [[nodiscard]] std::string_view name() const override { return "rotate"; }
  [[nodiscard]] std::string_view about() const override { return "the camera was turned"; }
  [[nodiscard]] std::span<const Parameter> parameters() const override { return kRotateParameters; }

  [[nodiscard]] Parameters draw(Random& random, int strength_percent) const override {
    return {{"millidegrees", draw_around_zero(random, kMaxRotateDrawn, strength_percent)}};
  }

  void apply(const Parameters& parameters, SceneImages& images) const override {
    Move::turn(parameters.at("millidegrees")).apply(images);
  }
};

}  // namespace

std::unique_ptr<const ImageChange> make_rotate() {
  return std::make_unique<Rotate>();
}

}  // namespace engram::augmentation
