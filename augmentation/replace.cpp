// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "augmentation/image_changes.h"
#include "augmentation/light.h"

namespace engram::augmentation {

namespace {

constexpr std::array<Parameter, 10> kReplaceParameters{
    {{"label", 0, 65535, "of the object; 0: every object"},
     {"pattern", 0, 3, "0 plain, 1 stripes upright, 2 stripes lying, 3 checks"},
     {"size_permille", 10, 1000, "of a stripe or check, of the image's height"},
     {"shading_percent", 0, 100, "how much of the object's light and shadow stays"},
     {"red", 0, 255, "of the first colour, grey levels"},
     {"green", 0, 255, "grey levels; of grey images, too"},
     {"blue", 0, 255, "grey levels"},
     {"other_red", 0, 255, "of the second colour, grey levels"},
     {"other_green", 0, 255, "grey levels"},
     {"other_blue", 0, 255, "grey levels"}}};

using Colour = std::array<int64_t, 3>;

/// The texture that is painted over the object.
struct Pattern {
  int64_t kind, size_pixels;
  Colour first, second;

  [[nodiscard]] const Colour& at(int64_t x, int64_t y) const {
    const int64_t column = kind == 2 ? 0 : x / size_pixels;
    const int64_t row = kind == 1 ? 0 : y / size_pixels;
    return kind == 0 || (column + row) % 2 == 0 ? first : second;
  }
};

class Replace final : public ImageChange {
 public:
  [[nodiscard]] std::string_view name() const override { return "replace"; }
  [[nodiscard]] std::string_view about() const override {
    return "another object of the same outline, plain, striped or checked";
  }
  [[nodiscard]] std::span<const Parameter> parameters() const override {
    return kReplaceParameters;
  }
  [[nodiscard]] bool needs_mask() const override { return true; }

  [[nodiscard]] Parameters draw(Random& random, int strength_percent) const override {
    Parameters drawn{{"label", 0},
                     {"pattern", random.between(0, 3)},
                     {"size_permille", random.between(20, 80)},
                     {"shading_percent", 100 - strength_percent / 2}};
    for (const char* colour : {"red", "green", "blue", "other_red", "other_green", "other_blue"})
      drawn[colour] = random.between(20, 235);
    return drawn;
  }

  void apply(const Parameters& p, SceneImages& images) const override {
    for (SceneImage& image : images.images) {
      if (image.role != PixelRole::kLight) continue;
      const cv::Mat mask = images.mask_of(p.at("label"), image.pixels.size());
      if (mask.empty()) continue;
      const Pattern pattern{
          p.at("pattern"),
          std::max<int64_t>(1, divided(p.at("size_permille") * image.pixels.rows, 1000)),
          {p.at("red"), p.at("green"), p.at("blue")},
          {p.at("other_red"), p.at("other_green"), p.at("other_blue")}};
      paint(image.pixels, mask, pattern, p.at("shading_percent"));
    }
  }

 private:
  static int64_t mean_lightness(const cv::Mat& pixels, const cv::Mat& mask) {
    int64_t sum = 0, count = 0;
    for (int y = 0; y < pixels.rows; ++y)
      for (int x = 0; x < pixels.cols; ++x)
        if (mask.at<uint8_t>(y, x) != 0) {
          sum += lightness_of(pixels.ptr<uint8_t>(y) + x * pixels.channels(), pixels.channels());
          ++count;
        }
    // The mean is a divisor, so it must not be zero.
    return std::max<int64_t>(1, count == 0 ? 0 : sum / count);
  }

  static void paint(cv::Mat& pixels, const cv::Mat& mask, const Pattern& pattern,
                    int64_t shading_percent) {
    const int64_t mean = mean_lightness(pixels, mask);
    const int channels = pixels.channels();
    for (int y = 0; y < pixels.rows; ++y)
      for (int x = 0; x < pixels.cols; ++x) {
        if (mask.at<uint8_t>(y, x) == 0) continue;
        uint8_t* pixel = pixels.ptr<uint8_t>(y) + x * channels;
        // The new object keeps the light and shadow of the old one: each pixel's deviation from the
        // object's mean lightness, relative to that mean, scales the pattern.
        const int64_t shade = (lightness_of(pixel, channels) - mean) * shading_percent;
        const Colour& colour = pattern.at(x, y);
        for (int c = 0; c < channels; ++c) {
          const int64_t level = colour[static_cast<size_t>(channels == 1 ? 1 : c)];
          pixel[c] = to_grey_level(divided(level * (100 * mean + shade), 100 * mean));
        }
      }
  }
};

}  // namespace

std::unique_ptr<const ImageChange> make_replace() {
  return std::make_unique<Replace>();
}

}  // namespace engram::augmentation
