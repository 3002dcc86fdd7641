// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstring>

#include "augmentation/image_changes.h"
#include "augmentation/light.h"

namespace engram::augmentation {

namespace {

constexpr int64_t kMaxSide = 400;
constexpr int64_t kMinSide = 50;
constexpr std::array<Parameter, 8> kOccludeParameters{
    {{"left_permille", 0, 1000, "of the width"},
     {"top_permille", 0, 1000, "of the height"},
     {"width_permille", 0, 1000, "of the width"},
     {"height_permille", 0, 1000, "of the height"},
     {"is_round", 0, 1, "1: an ellipse, 0: a rectangle"},
     {"red", 0, 255, "grey levels"},
     {"green", 0, 255, "grey levels; of grey images, too"},
     {"blue", 0, 255, "grey levels"}}};

/// Unit: pixels.
struct Shape {
  int64_t left, top, width, height;
  bool is_round;

  [[nodiscard]] bool covers(int64_t x, int64_t y) const {
    if (x < left || y < top || x >= left + width || y >= top + height) return false;
    if (!is_round) return true;
    // A pixel is covered if its middle lies in the ellipse; coordinates are in half pixels.
    const int64_t u = (2 * (x - left) + 1 - width) * height;
    const int64_t v = (2 * (y - top) + 1 - height) * width;
    return u * u + v * v <= width * width * height * height;
  }
};

class Occlude final : public ImageChange {
 public:
  [[nodiscard]] std::string_view name() const override { return "occlude"; }
  [[nodiscard]] std::string_view about() const override {
    return "something plain in front, without depth and label";
  }
  [[nodiscard]] std::span<const Parameter> parameters() const override {
    return kOccludeParameters;
  }

  [[nodiscard]] Parameters draw(Random& random, int strength_percent) const override {
    const int64_t max = std::max(kMinSide, kMaxSide * strength_percent / 100);
    const int64_t width = random.between(kMinSide, max);
    const int64_t height = random.between(kMinSide, max);
    Parameters drawn{{"left_permille", random.between(0, 1000 - width)},
                     {"top_permille", random.between(0, 1000 - height)},
                     {"width_permille", width},
                     {"height_permille", height},
                     {"is_round", random.between(0, 1)}};
    for (const char* colour : {"red", "green", "blue"}) drawn[colour] = random.between(0, 255);
    return drawn;
  }

  void apply(const Parameters& p, SceneImages& images) const override {
    const std::array<uint8_t, 3> colour{to_grey_level(p.at("red")), to_grey_level(p.at("green")),
                                        to_grey_level(p.at("blue"))};
    for (SceneImage& image : images.images)
      cover(p, image.pixels, image.role == PixelRole::kLight ? &colour : nullptr);
    if (!images.labels.empty()) cover(p, images.labels, nullptr);
  }

 private:
  /// Pixels become zero if `colour` is null.
  static void cover(const Parameters& p, cv::Mat& pixels, const std::array<uint8_t, 3>* colour) {
    const auto part = [&](const char* name, int side) { return divided(p.at(name) * side, 1000); };
    const Shape shape{part("left_permille", pixels.cols), part("top_permille", pixels.rows),
                      part("width_permille", pixels.cols), part("height_permille", pixels.rows),
                      p.at("is_round") == 1};
    for (int y = 0; y < pixels.rows; ++y)
      for (int x = 0; x < pixels.cols; ++x) {
        if (!shape.covers(x, y)) continue;
        uint8_t* pixel = pixels.ptr<uint8_t>(y) + static_cast<size_t>(x) * pixels.elemSize();
        if (colour == nullptr)
          std::memset(pixel, 0, pixels.elemSize());
        else if (pixels.channels() == 1)
          *pixel = (*colour)[1];
        else
          std::memcpy(pixel, colour->data(), 3);
      }
  }
};

}  // namespace

std::unique_ptr<const ImageChange> make_occlude() {
  return std::make_unique<Occlude>();
}

}  // namespace engram::augmentation
