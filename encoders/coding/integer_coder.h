// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "encoders/coding/adaptive_bit.h"

namespace engram::encoders {

/// Adaptive model of signed 64-bit integers in one context. It codes whether the integer is zero,
/// its sign, the number of bits of its magnitude in unary, then those bits. The first two of them
/// below the highest have models too.
///
/// Threading: one thread.
/// Source: docs/learning_methods.md, section "Numbers".
class IntegerModel {
 public:
  /// Max bits of a magnitude: that of INT64_MIN has 64.
  static constexpr size_t kWidths = 64;

  /// Encodes `value`, or decodes and returns a value; any bits decode to one.
  template <typename Port>
  int64_t code(Port& port, int64_t value);

 private:
  template <typename Port>
  uint64_t code_low_bits(Port& port, size_t width, uint64_t magnitude);

  AdaptiveBit zero_;
  AdaptiveBit sign_;
  std::array<AdaptiveBit, kWidths> wider_;  ///< Whether the magnitude has more than i + 1 bits.
  std::array<std::array<AdaptiveBit, 3>, kWidths> high_;
};

// Implementation of the template.

template <typename Port>
uint64_t IntegerModel::code_low_bits(Port& port, size_t width, uint64_t magnitude) {
  uint64_t result = 1;
  size_t node = 0;
  for (size_t left = width - 1; left > 0; --left) {
    const bool bit = ((magnitude >> (left - 1)) & 1) != 0;
    const bool is_modelled = width - 1 - left < 2;
    const bool coded =
        is_modelled ? high_[width - 1][node].code(port, bit) : port.code(bit, 1u << 15);
    node = coded ? 2 : 1;
    result = (result << 1) | (coded ? 1 : 0);
  }
  return result;
}

template <typename Port>
int64_t IntegerModel::code(Port& port, int64_t value) {
  if (zero_.code(port, value == 0)) return 0;
  const bool is_negative = sign_.code(port, value < 0);
  uint64_t magnitude = static_cast<uint64_t>(value);
  if (is_negative) magnitude = 0 - magnitude;
  size_t width = 1;
  while (width < kWidths && wider_[width - 1].code(port, (magnitude >> width) != 0)) ++width;
  magnitude = code_low_bits(port, width, magnitude);
  return static_cast<int64_t>(is_negative ? 0 - magnitude : magnitude);
}

}  // namespace engram::encoders
