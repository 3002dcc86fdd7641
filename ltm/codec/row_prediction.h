// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

namespace engram::ltm {

/// The instruction set to use. The result is the same for all.
enum class Vectors {
  kWidest,  ///< The widest vectors that the processor has.
  /// Vectors that every processor has. Tests use it to check that the results are the same.
  kPortable,
};

/// Size of an image with interleaved channels.
struct ImageSize {
  size_t height = 1;  ///< At least 1, like width.
  size_t width = 1;
  size_t channels = 1;       ///< 1 to 4.
  size_t element_bytes = 1;  ///< 1, 2 or 4: unsigned little-endian integers.
  bool is_float = false;     ///< The elements are float32; needs element_bytes = 4.

  [[nodiscard]] size_t bytes() const { return height * width * channels * element_bytes; }
};

/// Estimates from a few rows whether red and blue take fewer bytes as differences from green.
/// Returns false for fewer than three channels.
[[nodiscard]] bool prefers_colour_differences(std::span<const std::byte> image,
                                              const ImageSize& size);

/// Replaces each number by its difference from the prediction of its left, upper and upper left
/// neighbours (their median edge detector). The output is ordered by channel, then by byte of the
/// numbers.
///
/// With `colour_differences` (three channels or more) green comes first, then red minus green and
/// blue minus green. The first row uses only left neighbours, the first column only upper ones.
/// Differences are modulo the numbers' range. Those of 2 and 4 bytes are folded (0, -1, 1, -2, ...)
/// so that small ones have zero high bytes; float32 is first mapped to integers of the same order.
/// The result is identical on every processor. Needs residuals.size() == image.size() ==
/// size.bytes() (checked).
/// Source: M. Weinberger, G. Seroussi, G. Sapiro, "The LOCO-I lossless image compression
/// algorithm", 2000, section III-B (the predictor).
void predict_rows(std::span<const std::byte> image, const ImageSize& size, bool colour_differences,
                  std::span<std::byte> residuals, Vectors vectors = Vectors::kWidest);

/// The exact inverse of predict_rows. Any bytes are valid residuals.
void restore_rows(std::span<const std::byte> residuals, const ImageSize& size,
                  bool colour_differences, std::span<std::byte> image,
                  Vectors vectors = Vectors::kWidest);

}  // namespace engram::ltm
