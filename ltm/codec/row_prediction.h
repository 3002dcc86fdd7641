// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

namespace engram::ltm {

/// Which instructions to use; the result is the same.
enum class Vectors {
  kWidest,    ///< The widest that the processor has.
  kPortable,  ///< Those that every processor has; to test that nothing differs.
};

/// Size of an image whose channels lie beside each other in memory.
struct ImageSize {
  size_t height = 1;  ///< At least 1, like width.
  size_t width = 1;
  size_t channels = 1;       ///< 1 to 4.
  size_t element_bytes = 1;  ///< 1, 2 or 4: unsigned little-endian integers.
  bool is_float = false;     ///< The elements are float32; needs element_bytes = 4.

  [[nodiscard]] size_t bytes() const { return height * width * channels * element_bytes; }
};

/// Says whether red and blue are better told as differences from green, from a few rows.
/// False where there are fewer than three channels.
[[nodiscard]] bool prefers_colour_differences(std::span<const std::byte> image,
                                              const ImageSize& size);

/// Replaces every number by its difference from what its left, upper and upper left neighbours
/// suggest (their median edge detector), one channel and one byte of its numbers after the other.
///
/// With `colour_differences` (three channels or more) green comes first, then red and blue less
/// green. The first row knows only its left neighbours, the first column only its upper ones.
/// Differences are modulo the numbers' range; of 2 and 4 bytes they are folded (0, -1, 1, -2, ...)
/// so that the high bytes of small ones are zero, and float32 is ordered as an integer before.
/// Identical on every processor. Needs residuals.size() == image.size() == size.bytes() (checked).
/// Source: M. Weinberger, G. Seroussi, G. Sapiro, "The LOCO-I lossless image compression
/// algorithm", 2000, section III-B (the predictor).
void predict_rows(std::span<const std::byte> image, const ImageSize& size, bool colour_differences,
                  std::span<std::byte> residuals, Vectors vectors = Vectors::kWidest);

/// The exact inverse of predict_rows; any bytes are residuals of some image.
void restore_rows(std::span<const std::byte> residuals, const ImageSize& size,
                  bool colour_differences, std::span<std::byte> image,
                  Vectors vectors = Vectors::kWidest);

}  // namespace engram::ltm
