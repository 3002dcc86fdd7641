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

/// Max magnitude of a coefficient. Unit: 1/8 grey level.
inline constexpr int kMaxCoefficient = 32767;
inline constexpr int kCoefficientUnit = 8;

/// Transforms differences of images (-255 to 255) to coefficients with the same sum of squares.
/// Three channels are rotated to brightness and two colours, and each plane goes through a cosine
/// transform. If a side is no multiple of 8, the edge is repeated.
///
/// It uses integer arithmetic only, so the result is the same on every machine.
/// Shape: differences [H, W, C]; coefficients [planes, rows, columns, 64], low frequencies first.
[[nodiscard]] std::vector<int16_t> to_coefficients(std::span<const int16_t> differences,
                                                   const PixelShape& shape);

/// The inverse of to_coefficients(). It accepts any coefficients.
[[nodiscard]] std::vector<int16_t> from_coefficients(std::span<const int16_t> coefficients,
                                                     const PixelShape& shape);

}  // namespace engram::encoders
