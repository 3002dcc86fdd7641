// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/background_coder.h"

#include <algorithm>
#include <cstdlib>

#include "encoders/coding/binary_coder.h"
#include "encoders/coding/byte_model.h"
#include "encoders/coding/checked_block.h"
#include "ltm/core/check.h"

namespace engram::encoders {

namespace {

int median_edge(int left, int up, int corner) {
  if (corner >= std::max(left, up)) return std::min(left, up);
  if (corner <= std::min(left, up)) return std::max(left, up);
  return left + up - corner;
}

/// Codes the pixels of one scene in the order of their channels.
class ScenePixelCoder {
 public:
  ScenePixelCoder(std::span<uint8_t> pixels, const LatentGrid& shape, bool follows_channels)
      : pixels_(pixels),
        width_(static_cast<size_t>(shape.width)),
        height_(static_cast<size_t>(shape.height)),
        follows_channels_(follows_channels),
        residuals_(pixels.size()) {}

  template <typename Port>
  void code(Port& port, ByteModel& model) {
    size_t at = 0;
    for (size_t row = 0; at < pixels_.size(); ++row)
      for (size_t x = 0; x < width_; ++x, ++at) code_pixel(port, model, at, row % height_, x);
  }

 private:
  template <typename Port>
  void code_pixel(Port& port, ByteModel& model, size_t at, size_t y, size_t x) {
    const size_t plane = width_ * height_;
    const bool has_channel = at >= plane;
    const int left = x > 0 ? pixels_[at - 1] : y > 0 ? pixels_[at - width_] : 128;
    const int up = y > 0 ? pixels_[at - width_] : left;
    const int corner = x > 0 && y > 0 ? pixels_[at - width_ - 1] : up;
    const int right = y > 0 && x + 1 < width_ ? pixels_[at - width_ + 1] : up;
    const int before = has_channel ? residuals_[at - plane] : 0;
    const auto size = [](int value) { return static_cast<uint32_t>(std::abs(value)); };
    const uint32_t gradient = size(left - corner) + size(corner - up) + size(up - right);
    const uint32_t around =
        (x > 0 ? size(residuals_[at - 1]) : 0) + (y > 0 ? size(residuals_[at - width_]) : 0);
    const ByteModel::Contexts contexts{ByteModel::class_of(4 * gradient),
                                       ByteModel::class_of(8 * around),
                                       ByteModel::class_of(16 * size(before))};
    int guess = median_edge(left, up, corner);
    if (follows_channels_) guess = std::clamp(guess + before, 0, 255);
    // Differences wrap around, so each fits a byte.
    const int step = model.code(port, contexts, static_cast<int8_t>(pixels_[at] - guess));
    pixels_[at] = static_cast<uint8_t>(guess + step);
    residuals_[at] = static_cast<int16_t>(pixels_[at] - median_edge(left, up, corner));
  }

  std::span<uint8_t> pixels_;
  size_t width_, height_;
  bool follows_channels_;
  std::vector<int16_t> residuals_;  ///< Relative to the prediction from neighbours alone.
};

template <typename Port>
void code_scenes(Port& port, std::span<uint8_t> pixels, const LatentGrid& shape,
                 bool follows_channels) {
  ByteModel model;
  for (size_t first = 0; first < pixels.size(); first += shape.count())
    ScenePixelCoder(pixels.subspan(first, shape.count()), shape, follows_channels)
        .code(port, model);
}

constexpr BitProbability kEven = 1u << 15;

}  // namespace

uint64_t scenes_identity(size_t scenes, const LatentGrid& shape) {
  uint64_t sizes = scenes;
  for (const int size : {shape.channels, shape.height, shape.width})
    sizes = sizes * 0x9e3779b97f4a7c15u + static_cast<uint64_t>(size);
  return sizes;
}

std::vector<std::byte> encode_backgrounds(std::span<const uint8_t> pixels,
                                          const LatentGrid& shape) {
  ENGRAM_CHECK(shape.count() > 0 && pixels.size() % shape.count() == 0, "{} pixels in scenes of {}",
               pixels.size(), shape.count());
  std::vector<std::byte> smallest;
  // Which prediction is better depends on the images, so both are tried. The first bit says which
  // one was taken.
  for (const bool follows_channels : {false, true}) {
    BinaryEncoder encoder;
    encoder.code(follows_channels, kEven);
    std::vector<uint8_t> copy(pixels.begin(), pixels.end());
    code_scenes(encoder, copy, shape, follows_channels);
    std::vector<std::byte> bytes = encoder.finish();
    if (!follows_channels || bytes.size() < smallest.size()) smallest = std::move(bytes);
  }
  return with_checksum(std::move(smallest), scenes_identity(pixels.size() / shape.count(), shape));
}

Result<std::vector<uint8_t>> decode_backgrounds(std::span<const std::byte> bytes, size_t scenes,
                                                const LatentGrid& shape, std::string_view what) {
  ENGRAM_ASSIGN_OR_RETURN(const auto content,
                          without_checksum(bytes, what, scenes_identity(scenes, shape)));
  BinaryDecoder decoder(content);
  const bool follows_channels = decoder.code(false, kEven);
  std::vector<uint8_t> pixels(scenes * shape.count());
  code_scenes(decoder, pixels, shape, follows_channels);
  return pixels;
}

}  // namespace engram::encoders
