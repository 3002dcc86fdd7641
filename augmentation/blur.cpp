// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <opencv2/imgproc.hpp>

#include "augmentation/image_changes.h"
#include "augmentation/scene_images.h"

namespace engram::augmentation {

namespace {

constexpr int64_t kMaxBlurDrawn = 200;
constexpr std::array<Parameter, 1> kBlurParameters{
    {{"sigma_hundredths", 0, 1000, "standard deviation, hundredths of a pixel"}}};

class Blur final : public ImageChange {
 public:
  [[nodiscard]] std::string_view name() const override { return "blur"; }
  [[nodiscard]] std::string_view about() const override { return "out of focus"; }
  [[nodiscard]] std::span<const Parameter> parameters() const override { return kBlurParameters; }

  [[nodiscard]] Parameters draw(Random& random, int strength_percent) const override {
    return {{"sigma_hundredths", random.between(0, kMaxBlurDrawn * strength_percent / 100)}};
  }

  void apply(const Parameters& parameters, SceneImages& images) const override {
    const int64_t hundredths = parameters.at("sigma_hundredths");
    if (hundredths == 0) return;
    const int side = 2 * static_cast<int>((3 * hundredths + 99) / 100) + 1;
    // For bytes, OpenCV's filter works in fixed point and computes its kernel in software floats,
    // so it is bit-exact.
    for (SceneImage& image : images.images)
      if (image.role == PixelRole::kLight)
        cv::GaussianBlur(image.pixels, image.pixels, {side, side},
                         static_cast<double>(hundredths) / 100, 0, cv::BORDER_REPLICATE);
  }
};

}  // namespace

std::unique_ptr<const ImageChange> make_blur() {
  return std::make_unique<Blur>();
}

}  // namespace engram::augmentation
