// SPDX-License-Identifier: Apache-2.0
#include "speech/sights/changed_images.h"

#include <algorithm>
#include <cmath>

namespace engram::speech {

namespace {

/// Pixels of less saturation are grey: prints, metal, light.
constexpr double kMinSaturation = 0.2;
/// A pixel of a thing has its hue if it is at most so far from it. Unit: degrees.
constexpr double kMaxHueDistance = 30;
/// Light that differs by so much, of all and of each of red, green and blue.
constexpr double kLight = 0.15;
constexpr double kTint = 0.05;

double between(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

Hsv hsv_of(const uint8_t* rgb) {
  const double r = rgb[0] / 255.0;
  const double g = rgb[1] / 255.0;
  const double b = rgb[2] / 255.0;
  const double high = std::max({r, g, b});
  const double range = high - std::min({r, g, b});
  if (range <= 0) return {0, 0, high};
  double hue = high == r ? (g - b) / range : high == g ? (b - r) / range + 2 : (r - g) / range + 4;
  if (hue < 0) hue += 6;
  return {60 * hue, range / high, high};
}

void set_rgb(const Hsv& colour, uint8_t* rgb) {
  const std::array<double, 3> at{5, 3, 1};
  for (size_t i = 0; i < at.size(); ++i) {
    const double k = std::fmod(at.at(i) + colour.hue / 60, 6);
    const double share = std::clamp(std::min(k, 4 - k), 0.0, 1.0);
    const double level = colour.value * (1 - colour.saturation * share);
    rgb[i] = static_cast<uint8_t>(std::lround(std::clamp(255 * level, 0.0, 255.0)));
  }
}

double hue_distance(double a, double b) {
  const double distance = std::fmod(std::abs(a - b), 360);
  return std::min(distance, 360 - distance);
}

/// Calls `visit` with each pixel within an outline.
template <typename Pixel, typename Visit>
void visit_pixels(Pixel* pixels, int64_t height, int64_t width,
                  const std::vector<Eigen::Vector2d>& outline, const Visit& visit) {
  if (outline.empty()) return;
  Eigen::Vector2d low = outline.front();
  Eigen::Vector2d high = outline.front();
  for (const Eigen::Vector2d& corner : outline) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  const auto clamped = [](double share, int64_t size) {
    return static_cast<int64_t>(std::clamp(share, 0.0, 1.0) * static_cast<double>(size));
  };
  for (int64_t y = clamped(low.y(), height); y < std::min(height, clamped(high.y(), height) + 1);
       ++y)
    for (int64_t x = clamped(low.x(), width); x < std::min(width, clamped(high.x(), width) + 1);
         ++x)
      if (is_within(outline, {(static_cast<double>(x) + 0.5) / static_cast<double>(width),
                              (static_cast<double>(y) + 0.5) / static_cast<double>(height)}))
        visit(pixels + 3 * (y * width + x));
}

void mirror(std::vector<uint8_t>& pixels, int64_t height, int64_t width) {
  for (int64_t y = 0; y < height; ++y)
    for (int64_t x = 0; x < width / 2; ++x)
      for (int64_t c = 0; c < 3; ++c)
        std::swap(pixels[static_cast<size_t>(3 * (y * width + x) + c)],
                  pixels[static_cast<size_t>(3 * (y * width + width - 1 - x) + c)]);
}

void mirror(ImageTruth& truth, const CellGrid& grid, const std::vector<int64_t>& mirrored_where) {
  for (int row = 0; row < grid.rows; ++row) {
    const auto begin = truth.kinds.begin() + row * grid.columns;
    std::reverse(begin, begin + grid.columns);
  }
  for (TrueSight& thing : truth.things)
    thing.where = mirrored_where.at(static_cast<size_t>(thing.where));
}

}  // namespace

void ColourLooks::see(const idf::NdArray& image, const ImageTruth& truth) {
  const auto pixels = image.values<uint8_t>();
  for (const TrueSight& thing : truth.things) {
    if (thing.colour < 0 || !thing.is_in_sight) continue;
    const auto colour = static_cast<size_t>(thing.colour);
    if (seen_.size() <= colour) seen_.resize(colour + 1);
    Seen& seen = seen_[colour];
    visit_pixels(pixels.data(), image.shape()[0], image.shape()[1], thing.outline,
                 [&seen](const uint8_t* pixel) {
                   const Hsv hsv = hsv_of(pixel);
                   if (hsv.saturation < kMinSaturation) return;
                   const auto bin = std::min(kHues - 1, static_cast<size_t>(hsv.hue / 360 * kHues));
                   const double weight = hsv.saturation * hsv.value;
                   seen.weight.at(bin) += weight;
                   seen.hue.at(bin) += weight * hsv.hue;
                   seen.saturation.at(bin) += weight * hsv.saturation;
                   seen.value.at(bin) += weight * hsv.value;
                 });
  }
}

Hsv ColourLooks::look(int64_t colour) const {
  if (colour < 0 || static_cast<size_t>(colour) >= seen_.size()) return {};
  const Seen& seen = seen_[static_cast<size_t>(colour)];
  const auto max = std::max_element(seen.weight.begin(), seen.weight.end());
  if (*max <= 0) return {};
  const auto bin = static_cast<size_t>(max - seen.weight.begin());
  return {seen.hue.at(bin) / *max, seen.saturation.at(bin) / *max, seen.value.at(bin) / *max};
}

ChangedImage change_image(const idf::NdArray& image, const ImageTruth& truth, const CellGrid& grid,
                          const ColourLooks& looks, const std::vector<int64_t>& mirrored_where,
                          std::mt19937_64& random) {
  const int64_t height = image.shape()[0];
  const int64_t width = image.shape()[1];
  const auto from = image.values<uint8_t>();
  std::vector<uint8_t> pixels(from.begin(), from.end());
  ImageTruth changed = truth;
  for (TrueSight& thing : changed.things) {
    const Hsv own = looks.look(thing.colour);
    if (own.saturation <= 0) continue;
    const auto colour = static_cast<int64_t>(random() % looks.colours());
    const Hsv other = looks.look(colour);
    if (other.saturation <= 0 || colour == thing.colour) continue;
    thing.colour = colour;
    visit_pixels(pixels.data(), height, width, thing.outline, [&](uint8_t* pixel) {
      const Hsv hsv = hsv_of(pixel);
      if (hsv.saturation < kMinSaturation || hue_distance(hsv.hue, own.hue) > kMaxHueDistance)
        return;
      set_rgb({other.hue, std::min(1.0, hsv.saturation * other.saturation / own.saturation),
               std::min(1.0, hsv.value * other.value / own.value)},
              pixel);
    });
  }
  const double light = between(random, 1 - kLight, 1 + kLight);
  std::array<double, 3> gain{};
  for (double& one : gain) one = light * between(random, 1 - kTint, 1 + kTint);
  for (size_t i = 0; i < pixels.size(); ++i)
    pixels[i] = static_cast<uint8_t>(std::min(255.0, pixels[i] * gain.at(i % 3)));
  if (random() % 2 == 1) {
    mirror(pixels, height, width);
    mirror(changed, grid, mirrored_where);
  }
  return {idf::NdArray::take({height, width, 3}, std::move(pixels)), std::move(changed)};
}

const idf::NdArray* image_in(const idf::Data& value) {
  const auto is_image = [](const idf::NdArray* array) {
    return array != nullptr && array->type() == idf::ElementType::kUInt8 &&
           array->shape().size() == 3 && array->shape()[2] == 3;
  };
  if (const auto* array = value.get_if<idf::NdArray>(); is_image(array)) return array;
  const auto* dict = value.get_if<idf::Dict>();
  if (dict == nullptr) return nullptr;
  for (const idf::DictEntry& member : *dict)
    if (const auto* array = member.value.get_if<idf::NdArray>(); is_image(array)) return array;
  return nullptr;
}

idf::Data with_image(const idf::Data& value, idf::NdArray image) {
  idf::Data changed = value;
  auto* dict = changed.get_if<idf::Dict>();
  if (dict == nullptr) return idf::Data(std::move(image));
  const idf::NdArray* old = image_in(changed);
  for (const idf::DictEntry& member : *dict)
    if (member.value.get_if<idf::NdArray>() == old) {
      dict->set(member.key, idf::Data(std::move(image)));
      break;
    }
  return changed;
}

}  // namespace engram::speech
