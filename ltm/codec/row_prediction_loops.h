// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to ltm/codec/row_prediction.cpp: loops over one row each. The compiler vectorises them
// for the processor for which the enclosing function is compiled.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#define ENGRAM_INLINE __attribute__((always_inline)) inline

namespace engram::ltm::row_loops {

/// The median of left, upper and left + upper - corner.
template <typename T>
ENGRAM_INLINE T median_edge(T left, T upper, T corner) {
  const T min = std::min(left, upper);
  const T max = std::max(left, upper);
  return static_cast<T>(min + max - std::min(std::max(corner, min), max));
}

/// Maps 0, -1, 1, -2, ... to 0, 1, 2, 3, ...
template <typename T>
ENGRAM_INLINE T fold(T difference) {
  const auto sign = static_cast<T>(0 - (difference >> (8 * sizeof(T) - 1)));
  return static_cast<T>(static_cast<T>(difference << 1) ^ sign);
}

template <typename T>
ENGRAM_INLINE T unfold(T folded) {
  return static_cast<T>((folded >> 1) ^ static_cast<T>(0 - (folded & 1)));
}

/// Maps the bits of a float to an integer of the same order, and back. It is a bijection: NaNs keep
/// their bits.
ENGRAM_INLINE uint32_t ordered(uint32_t bits) {
  return bits ^ (static_cast<uint32_t>(0 - (bits >> 31)) | 0x80000000u);
}

ENGRAM_INLINE uint32_t unordered(uint32_t order) {
  return order ^ (static_cast<uint32_t>((order >> 31) - 1) | 0x80000000u);
}

/// A row of one channel, with room for the left neighbour of its first number.
template <typename T>
class Line {
 public:
  explicit Line(size_t width) : values_(width + 1) {}
  T* data() { return values_.data() + 1; }
  /// The first column has only an upper neighbour, so its left and corner are set to that value.
  void set_left(T value) { values_[0] = value; }

 private:
  std::vector<T> values_;
};

template <typename T, size_t kChannels>
using Rows = std::array<T*, kChannels>;

template <typename T, size_t kChannels>
ENGRAM_INLINE void split_channels(const T* __restrict pixels, const Rows<T, kChannels>& rows,
                                  size_t width) {
  for (size_t c = 0; c < kChannels; ++c) {
    T* __restrict row = rows[c];
    for (size_t x = 0; x < width; ++x) row[x] = pixels[x * kChannels + c];
  }
}

template <typename T, size_t kChannels>
ENGRAM_INLINE void join_channels(const Rows<T, kChannels>& rows, T* __restrict pixels,
                                 size_t width) {
  for (size_t x = 0; x < width; ++x)
    for (size_t c = 0; c < kChannels; ++c) pixels[x * kChannels + c] = rows[c][x];
}

template <typename T>
ENGRAM_INLINE void subtract(T* __restrict row, const T* __restrict other, size_t width) {
  for (size_t x = 0; x < width; ++x) row[x] = static_cast<T>(row[x] - other[x]);
}

template <typename T>
ENGRAM_INLINE void add(T* __restrict row, const T* __restrict other, size_t width) {
  for (size_t x = 0; x < width; ++x) row[x] = static_cast<T>(row[x] + other[x]);
}

/// Predicts a row. `row` and `above` must have a left neighbour before them.
template <typename T>
ENGRAM_INLINE void predict_line(const T* __restrict row, const T* __restrict above,
                                T* __restrict residuals, size_t width) {
  const T* __restrict left = row - 1;
  const T* __restrict corner = above - 1;
  for (size_t x = 0; x < width; ++x) {
    const auto difference = static_cast<T>(row[x] - median_edge(left[x], above[x], corner[x]));
    if constexpr (sizeof(T) == 1)
      residuals[x] = difference;
    else
      residuals[x] = fold(difference);
  }
}

/// Restores a row. Each number depends on the previous one, so the channels are interleaved to keep
/// the processor busy.
template <typename T, size_t kChannels>
ENGRAM_INLINE void restore_lines(const Rows<const T, kChannels>& residuals,
                                 const Rows<T, kChannels>& above, const Rows<T, kChannels>& rows,
                                 size_t width) {
  std::array<T, kChannels> left;
  std::array<T, kChannels> corner;
  for (size_t c = 0; c < kChannels; ++c) left[c] = corner[c] = above[c][0];
  for (size_t x = 0; x < width; ++x)
    for (size_t c = 0; c < kChannels; ++c) {
      const T upper = above[c][x];
      left[c] = static_cast<T>(unfold(residuals[c][x]) + median_edge(left[c], upper, corner[c]));
      corner[c] = upper;
      rows[c][x] = left[c];
    }
}

/// Writes pixels. With `colour_differences` the first row is green, and the next two are
/// differences from green.
template <size_t kChannels>
ENGRAM_INLINE void join_pixels(const Rows<uint8_t, kChannels>& rows, bool colour_differences,
                               uint8_t* __restrict pixels, size_t width) {
  if (kChannels < 3 || !colour_differences)
    return join_channels<uint8_t, kChannels>(rows, pixels, width);
  if constexpr (kChannels >= 3) {
    const uint8_t* __restrict green = rows[0];
    const uint8_t* __restrict red = rows[1];
    const uint8_t* __restrict blue = rows[2];
    for (size_t x = 0; x < width; ++x) {
      uint8_t* pixel = pixels + x * kChannels;
      pixel[0] = static_cast<uint8_t>(red[x] + green[x]);
      pixel[1] = green[x];
      pixel[2] = static_cast<uint8_t>(blue[x] + green[x]);
      if constexpr (kChannels == 4) pixel[3] = rows[3][x];
    }
  }
}

template <typename T>
ENGRAM_INLINE void split_bytes(const T* __restrict row, uint8_t* __restrict out, size_t stride,
                               size_t width) {
  for (size_t b = 0; b < sizeof(T); ++b)
    for (size_t x = 0; x < width; ++x)
      out[b * stride + x] = static_cast<uint8_t>(row[x] >> (8 * b));
}

template <typename T>
ENGRAM_INLINE void join_bytes(const uint8_t* __restrict in, size_t stride, T* __restrict row,
                              size_t width) {
  for (size_t x = 0; x < width; ++x) row[x] = in[x];
  for (size_t b = 1; b < sizeof(T); ++b)
    for (size_t x = 0; x < width; ++x)
      row[x] = static_cast<T>(row[x] | static_cast<T>(in[b * stride + x]) << (8 * b));
}

/// Green first, then red and blue, then any other channel.
template <typename T, size_t kChannels>
Rows<T, kChannels> in_coded_order(Rows<T, kChannels> rows, bool colour_differences) {
  if constexpr (kChannels >= 3)
    if (colour_differences) std::swap(rows[0], rows[1]);
  return rows;
}

}  // namespace engram::ltm::row_loops
