// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "augmentation/image_changes.h"
#include "augmentation/light.h"

namespace engram::augmentation {

namespace {

constexpr std::array<Parameter, 5> kParameters{
    {{"label", 0, 65535, "of the object; 0: every object"},
     {"red", 0, 255, "of the new colour, grey levels"},
     {"green", 0, 255, "grey levels"},
     {"blue", 0, 255, "grey levels"},
     {"percent", 0, 100, "how much of the old colour is gone"}}};

class Recolour final : public ImageChange {
 public:
  [[nodiscard]] std::string_view name() const override { return "recolour"; }
  [[nodiscard]] std::string_view about() const override {
    return "an object has another colour, as light as before; nothing on grey images";
  }
  [[nodiscard]] std::span<const Parameter> parameters() const override { return kParameters; }
  [[nodiscard]] bool needs_mask() const override { return true; }

  [[nodiscard]] Parameters draw(Random& random, int strength_percent) const override {
    // One channel is full, one is nearly empty and one is drawn, which gives all hues.
    std::array<int64_t, 3> levels{255, 32, random.between(32, 255)};
    for (size_t i = 2; i > 0; --i)
      std::swap(levels[i], levels[static_cast<size_t>(random.between(0, static_cast<int>(i)))]);
    return {{"label", 0},
            {"red", levels[0]},
            {"green", levels[1]},
            {"blue", levels[2]},
            {"percent", random.between(strength_percent / 2, strength_percent)}};
  }

  void apply(const Parameters& p, SceneImages& images) const override {
    const std::array<uint8_t, 3> colour{to_grey_level(p.at("red")), to_grey_level(p.at("green")),
                                        to_grey_level(p.at("blue"))};
    for (SceneImage& image : images.images) {
      if (image.role != PixelRole::kLight || image.pixels.channels() != 3) continue;
      const cv::Mat mask = images.mask_of(p.at("label"), image.pixels.size());
      if (!mask.empty()) paint(image.pixels, mask, colour, p.at("percent"));
    }
  }

 private:
  static void paint(cv::Mat& pixels, const cv::Mat& mask, const std::array<uint8_t, 3>& colour,
                    int64_t percent) {
    const int64_t own = std::max<int64_t>(1, lightness_of(colour.data(), 3));
    for (int y = 0; y < pixels.rows; ++y)
      for (int x = 0; x < pixels.cols; ++x) {
        if (mask.at<uint8_t>(y, x) == 0) continue;
        auto& pixel = pixels.at<cv::Vec3b>(y, x);
        const int64_t lightness = lightness_of(pixel.val, 3);
        for (int c = 0; c < 3; ++c) {
          const int64_t painted =
              std::min<int64_t>(255, divided(lightness * colour[static_cast<size_t>(c)], own));
          pixel[c] = to_grey_level(divided(pixel[c] * (100 - percent) + painted * percent, 100));
        }
      }
  }
};

}  // namespace

std::unique_ptr<const ImageChange> make_recolour() {
  return std::make_unique<Recolour>();
}

}  // namespace engram::augmentation
