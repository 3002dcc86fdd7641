// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/weight_coder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>

#include "encoders/coding/adaptive_bit.h"
#include "encoders/coding/binary_coder.h"
#include "encoders/coding/checked_block.h"
#include "ltm/core/check.h"

namespace engram::encoders {

namespace {

/// Mean magnitudes are in 1/256. They start at a typical mean of weights up to 127.
constexpr int32_t kOne = 256;
constexpr int32_t kFirstMean = 32 * kOne;
constexpr int kColumnRate = 3, kRowRate = 4;
constexpr size_t kClasses = 64;

/// Class of a mean magnitude, with four classes per doubling.
size_t class_of(int32_t mean) {
  const auto width = std::bit_width(static_cast<uint32_t>(mean));
  if (width < 3) return 0;
  return std::min(4 * static_cast<size_t>(width) + ((static_cast<size_t>(mean) >> (width - 3)) & 3),
                  kClasses - 1);
}

}  // namespace

/// The code of a weight is the number of bits of its magnitude, its two bits below the highest, and
/// then the rest and the sign, which are coded as equally likely.
struct WeightCoder::Model {
  static constexpr size_t kWidths = 8;  ///< 0 to 7 bits.

  std::array<std::array<AdaptiveBit, kWidths>, kClasses> width;  ///< Trees of eight widths.
  std::array<std::array<AdaptiveBit, 3>, kWidths> high;          ///< Trees of two bits.

  template <typename Port>
  int code(Port& port, size_t expected, int weight) {
    // Magnitudes count from 0 for positive and from -1 for negative values, so both fit 7 bits.
    uint32_t magnitude = static_cast<uint32_t>(weight < 0 ? ~weight : weight);
    const auto width_of_it = static_cast<uint32_t>(std::bit_width(magnitude));
    size_t node = 1;
    for (int bit = 2; bit >= 0; --bit)
      node = 2 * node + (width[expected][node].code(port, ((width_of_it >> bit) & 1) != 0) ? 1 : 0);
    const auto bits = static_cast<int>(node - kWidths);
    int left = std::max(bits - 1, 0);
    uint32_t known = bits > 0 ? 1 : 0;
    for (size_t at = 0; left > 0 && bits - 1 - left < 2; at = known & 1 ? 2 : 1) {
      --left;
      known =
          2 * known +
          (high[static_cast<size_t>(bits)][at].code(port, ((magnitude >> left) & 1) != 0) ? 1 : 0);
    }
    const uint32_t low = magnitude & ((1u << left) - 1);
    const uint32_t even = port.code_even(2 * low + (weight < 0 ? 1 : 0), left + 1);
    const auto decoded = static_cast<int>((known << left) | (even >> 1));
    return (even & 1) != 0 ? ~decoded : decoded;
  }
};

uint64_t shape_identity(size_t rows, size_t columns) {
  return uint64_t{rows} * 0x9e3779b97f4a7c15u + columns;
}

WeightCoder::WeightCoder() : model_(std::make_unique<Model>()) {}
WeightCoder::~WeightCoder() = default;

template <typename Port>
void WeightCoder::code(Port& port, std::span<int8_t> weights, size_t columns) {
  std::vector<int32_t> column_means(columns, kFirstMean);
  for (size_t first = 0; first < weights.size(); first += columns) {
    int32_t row_mean = kFirstMean;
    for (size_t i = 0; i < columns; ++i) {
      int8_t& weight = weights[first + i];
      int32_t& column_mean = column_means[i];
      // One context is enough: three mixed ones would save 13 kB of 1.76 MB and take 2.6 times as
      // long to decode (experiments/learning/LOG.md).
      const size_t expected = class_of((column_mean + row_mean) / 2);
      weight = static_cast<int8_t>(model_->code(port, expected, weight));
      const int32_t magnitude = std::abs(int32_t{weight}) * kOne;
      column_mean += (magnitude - column_mean) >> kColumnRate;
      row_mean += (magnitude - row_mean) >> kRowRate;
    }
  }
}

std::vector<std::byte> WeightCoder::encode(std::span<const int8_t> weights, size_t columns) {
  ENGRAM_CHECK(columns > 0 && weights.size() % columns == 0, "{} weights in rows of {}",
               weights.size(), columns);
  BinaryEncoder encoder;
  std::vector<int8_t> copy(weights.begin(), weights.end());
  code(encoder, copy, columns);
  return with_checksum(encoder.finish(), shape_identity(weights.size() / columns, columns));
}

Result<std::vector<int8_t>> WeightCoder::decode(std::span<const std::byte> bytes, size_t rows,
                                                size_t columns, std::string_view what) {
  ENGRAM_ASSIGN_OR_RETURN(const auto content,
                          without_checksum(bytes, what, shape_identity(rows, columns)));
  BinaryDecoder decoder(content);
  std::vector<int8_t> weights(rows * columns);
  code(decoder, weights, columns);
  return weights;
}

}  // namespace engram::encoders
