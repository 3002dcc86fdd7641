// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "augmentation/image_changes.h"
#include "augmentation/move.h"

namespace engram::augmentation {

namespace {

constexpr int64_t kMaxShiftDrawn = 100;
constexpr std::array<Parameter, 2> kShiftParameters{
    {{"right_permille", -1000, 1000, "of the width, rounded to whole pixels"},
     {"down_permille", -1000, 1000, "of the height, rounded to whole pixels"}}};

class Shift final : public ImageChange {
 public:
  [[nodiscard]] std::string_view name() const override { return "shift"; }
  [[nodiscard]] std::string_view about() const override {
    return "the camera looked elsewhere: by whole pixels";
  }
  [[nodiscard]] std::span<const Parameter> parameters() const override { return kShiftParameters; }

  [[nodiscard]] Parameters draw(Random& random, int strength_percent) const override {
    return {{"right_permille", draw_around_zero(random, kMaxShiftDrawn, strength_percent)},
            {"down_permille", draw_around_zero(random, kMaxShiftDrawn, strength_percent)}};
  }

  void apply(const Parameters& parameters, SceneImages& images) const override {
    Move move;
    move.right_permille = parameters.at("right_permille");
    move.down_permille = parameters.at("down_permille");
    move.apply(images);
  }
};

}  // namespace

std::unique_ptr<const ImageChange> make_shift() {
  return std::make_unique<Shift>();
}

}  // namespace engram::augmentation
