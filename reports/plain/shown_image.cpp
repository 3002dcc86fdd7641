// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/shown_image.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ltm/codec/codec.h"
#include "ltm/codec/png.h"
#include "ltm/core/buffer.h"

namespace engram::reports {

namespace {

template <typename T>
ShownImage scaled(const idf::NdArray& image) {
  const auto values = image.values<T>();
  double min = std::numeric_limits<double>::infinity();
  double max = -min;
  for (const T value : values) {
    const auto number = static_cast<double>(value);
    // Depth cameras tell by zero that they do not know.
    if (!std::isfinite(number) || number == 0) continue;
    min = std::min(min, number);
    max = std::max(max, number);
  }
  if (min > max) min = max = 0;
  const double scale = max > min ? 255 / (max - min) : 0;
  std::vector<uint8_t> grey(values.size());
  std::ranges::transform(values, grey.begin(), [&](T value) {
    const auto number = static_cast<double>(value);
    if (!std::isfinite(number)) return uint8_t{0};
    return static_cast<uint8_t>(std::lround(std::clamp((number - min) * scale, 0.0, 255.0)));
  });
  return {idf::NdArray::take(image.shape(), std::move(grey)), std::pair(min, max)};
}

}  // namespace

ShownImage shown_image(const idf::NdArray& image) {
  if (image.type() == idf::ElementType::kUInt16) return scaled<uint16_t>(image);
  if (image.type() == idf::ElementType::kFloat32) return scaled<float>(image);
  return {image};
}

Result<ShownImage> error_map(const idf::NdArray& recorded, const idf::NdArray& other) {
  if (recorded.type() != other.type() || recorded.shape() != other.shape() ||
      recorded.type() != idf::ElementType::kUInt8)
    return invalid_argument("an error map of {} {} and {} {}: needs two equal images of 8 bits",
                            to_string(recorded.type()), idf::to_string(recorded.shape()),
                            to_string(other.type()), idf::to_string(other.shape()));
  const auto a = recorded.values<uint8_t>();
  const auto b = other.values<uint8_t>();
  std::vector<uint8_t> map(a.size());
  std::ranges::transform(a, b, map.begin(), [](uint8_t x, uint8_t y) {
    return static_cast<uint8_t>(x > y ? x - y : y - x);
  });
  constexpr double kMaxGain = 16;
  const uint8_t largest = map.empty() ? uint8_t{0} : std::ranges::max(map);
  const double gain = largest == 0 ? 1 : std::min(kMaxGain, 255.0 / largest);
  for (uint8_t& level : map) level = static_cast<uint8_t>(std::lround(level * gain));
  return ShownImage{.pixels = idf::NdArray::take(recorded.shape(), std::move(map)), .gain = gain};
}

Result<std::string> encoded_image(const idf::NdArray& pixels, const std::string& as, int quality) {
  std::vector<std::byte> bytes;
  if (as == "png") {
    ENGRAM_ASSIGN_OR_RETURN(bytes, ltm::png_codec().encode(pixels));
  } else {
    ENGRAM_ASSIGN_OR_RETURN(const auto codec, ltm::make_codec(fmt::format("jpeg:{}", quality)));
    ENGRAM_ASSIGN_OR_RETURN(bytes, codec->encode(pixels));
  }
  return std::string(as_text(bytes));
}

}  // namespace engram::reports
