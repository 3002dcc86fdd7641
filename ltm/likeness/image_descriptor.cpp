// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/image_descriptor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace engram::ltm {

namespace {

constexpr int kDescribedSide = 128;
constexpr int kCells = 8;
constexpr int kCellSide = kDescribedSide / kCells;
constexpr int kDirections = 9;

/// OpenCV's type of the elements, or nothing.
std::optional<int> depth_of(idf::ElementType type) {
  switch (type) {
    case idf::ElementType::kUInt8:
      return CV_8U;
    case idf::ElementType::kUInt16:
      return CV_16U;
    case idf::ElementType::kFloat32:
      return CV_32F;
    default:
      return std::nullopt;
  }
}

/// The image as floats of the described size. Shape: [128, 128, C].
cv::Mat reduced(const idf::NdArray& image, const ImageSize& size, int depth) {
  const cv::Mat whole(static_cast<int>(size.height), static_cast<int>(size.width),
                      CV_MAKETYPE(depth, static_cast<int>(size.channels)),
                      const_cast<std::byte*>(image.bytes().data()));
  cv::Mat floats;
  whole.convertTo(floats, CV_32F);
  // A depth camera has no number where it saw nothing.
  if (depth == CV_32F) cv::patchNaNs(floats, 0);
  cv::Mat small;
  cv::resize(floats, small, cv::Size(kDescribedSide, kDescribedSide), 0, 0, cv::INTER_AREA);
  return small;
}

/// The difference of two pixels in the channel where they differ more than in the others.
float strongest(const float* a, const float* b, int channels) {
  float strongest = 0;
  for (int c = 0; c < channels; ++c)
    if (const float difference = b[c] - a[c]; std::abs(difference) > std::abs(strongest))
      strongest = difference;
  return strongest;
}

void add_gradient(float dx, float dy, float* cell) {
  const float strength = std::hypot(dx, dy);
  if (!(strength > 0) || !std::isfinite(strength)) return;
  // An edge is the same from both sides: directions repeat after half a turn.
  float turn = std::atan2(dy, dx) / std::numbers::pi_v<float>;
  if (turn < 0) turn += 1;
  const float at = turn * kDirections;
  const int below = std::min(static_cast<int>(at), kDirections);
  const float share = at - static_cast<float>(below);
  cell[below % kDirections] += strength * (1 - share);
  cell[(below + 1) % kDirections] += strength * share;
}

}  // namespace

std::string ImageSize::to_string() const {
  return fmt::format("{} x {} x {}", width, height, channels);
}

std::optional<ImageSize> image_size_of(const idf::NdArray& array) {
  constexpr int64_t kMinSide = 8;
  constexpr int64_t kMaxSide = 1 << 15;
  constexpr int64_t kMaxChannels = 4;
  if (array.rank() != 2 && array.rank() != 3) return std::nullopt;
  const ImageSize size{array.shape()[1], array.shape()[0],
                       array.rank() == 3 ? array.shape()[2] : 1};
  const bool is_image = size.width >= kMinSide && size.height >= kMinSide &&
                        size.width <= kMaxSide && size.height <= kMaxSide && size.channels >= 1 &&
                        size.channels <= kMaxChannels && depth_of(array.type()).has_value();
  return is_image ? std::optional(size) : std::nullopt;
}

Result<std::vector<float>> describe_image(const idf::NdArray& image) {
  const auto size = image_size_of(image);
  if (!size)
    return invalid_argument(
        "found an array {} {}, and an image was needed: uint8, uint16 or float32 [H, W, C] with "
        "sides from 8 pixels on",
        idf::to_string(image.type()), idf::to_string(image.shape()));
  const cv::Mat pixels = reduced(image, *size, *depth_of(image.type()));
  const int channels = pixels.channels();
  std::vector<float> descriptor(kDescriptorSize, 0.0f);
  for (int y = 0; y < kDescribedSide; ++y) {
    const auto* above = pixels.ptr<float>(std::max(y - 1, 0));
    const auto* row = pixels.ptr<float>(y);
    const auto* under = pixels.ptr<float>(std::min(y + 1, kDescribedSide - 1));
    for (int x = 0; x < kDescribedSide; ++x) {
      const bool is_inside = x > 0 && x + 1 < kDescribedSide && y > 0 && y + 1 < kDescribedSide;
      if (!is_inside) continue;
      const float dx = strongest(row + (x - 1) * channels, row + (x + 1) * channels, channels);
      const float dy = strongest(above + x * channels, under + x * channels, channels);
      const int cell = (y / kCellSide) * kCells + x / kCellSide;
      add_gradient(dx, dy, descriptor.data() + cell * kDirections);
    }
  }
  float square = 0;
  for (float& sum : descriptor) {
    square += sum;
    sum = std::sqrt(sum);
  }
  if (square > 0)
    for (float& root : descriptor) root /= std::sqrt(square);
  return descriptor;
}

}  // namespace engram::ltm
