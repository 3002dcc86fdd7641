// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "encoders/coding/mixer.h"
#include "encoders/coding/odds_bit.h"

namespace engram::encoders {

/// Adaptive model of integers from -128 to 127 whose magnitudes several contexts tell of: sign,
/// number of bits, two highest bits below the first; what is left of them is as it is.
///
/// Each context has an estimate of the number of bits; a mixer joins them by their log odds. The
/// first one tells of the sign: zero counts as positive, so it is not even where zeros are many.
/// Threading: one thread.
class ByteModel {
 public:
  static constexpr size_t kContexts = 3;
  /// Classes of each context, as class_of makes them.
  static constexpr size_t kClasses = 24;
  using Contexts = std::array<size_t, kContexts>;

  /// The class of a mean magnitude in 1/16, from 0 on: two for each doubling.
  static size_t class_of(uint32_t sixteenths);

  ByteModel();

  /// Writes `value`, or reads and returns one: any bits give one. `contexts` are below kClasses.
  template <typename Port>
  int code(Port& port, const Contexts& contexts, int value);

 private:
  static constexpr size_t kWidths = 8;           ///< 0 to 7 bits.
  static constexpr size_t kNodes = 2 * kWidths;  ///< The width of either sign: trees of eight.
  static constexpr size_t kHigh = 4;             ///< Bits below the first: a tree of two.
  using ByteMixer = Mixer<kContexts + 1>;

  template <typename Port>
  bool code_mixed(Port& port, const Contexts& contexts, size_t node, bool bit);
  template <typename Port>
  uint32_t code_low_bits(Port& port, size_t side, uint32_t width, uint32_t magnitude);

  const OddsTable& odds_;
  std::vector<OddsBit> bits_;      ///< [context, class, node]
  std::vector<ByteMixer> mixers_;  ///< [node]
  std::array<AdaptiveBit, kClasses> sign_;
  std::array<AdaptiveBit, 2 * kWidths * kHigh> high_;
};

}  // namespace engram::encoders
