// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace engram::encoders {

/// Pixels of an image: [height, width, channels].
struct PixelShape {
  int height = 0;
  int width = 0;
  int channels = 0;

  [[nodiscard]] size_t count() const {
    return static_cast<size_t>(height) * static_cast<size_t>(width) * static_cast<size_t>(channels);
  }
};

/// The blocks of 8 x 8 pixels that cover an image, one plane per channel.
struct BlockGrid {
  static constexpr size_t kSide = 8;
  static constexpr size_t kCoefficients = kSide * kSide;

  size_t planes = 0, rows = 0, columns = 0;

  explicit BlockGrid(const PixelShape& shape)
      : planes(static_cast<size_t>(shape.channels)),
        rows((static_cast<size_t>(shape.height) + kSide - 1) / kSide),
        columns((static_cast<size_t>(shape.width) + kSide - 1) / kSide) {}

  [[nodiscard]] size_t blocks() const { return planes * rows * columns; }
  [[nodiscard]] size_t coefficients() const { return blocks() * kCoefficients; }
};

/// Coefficients are in 1/8 grey level and lie within this, either way.
inline constexpr int kMaxCoefficient = 32767;
inline constexpr int kCoefficientUnit = 8;

/// Differences of images (-255 to 255) as coefficients whose squares sum to theirs: three channels
/// are turned towards brightness and two colours, each plane goes through a cosine transform.
/// Images whose sides are no multiple of 8 are continued by their edge.
///
/// Integer arithmetic only: the same on every machine.
/// Shape: differences [H, W, C]; coefficients [planes, rows, columns, 64], slow changes first.
[[nodiscard]] std::vector<int16_t> to_coefficients(std::span<const int16_t> differences,
                                                   const PixelShape& shape);

/// Any coefficients are good.
[[nodiscard]] std::vector<int16_t> from_coefficients(std::span<const int16_t> coefficients,
                                                     const PixelShape& shape);

}  // namespace engram::encoders
