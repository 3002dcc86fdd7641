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

/// Adaptive model of integers from -128 to 127 with several contexts of their magnitude. It models
/// the sign, the number of bits and the two highest bits below the first one; the other bits are
/// coded as equally likely.
///
/// Each context has an estimate of the number of bits, and a mixer combines them by their log odds.
/// The first context also estimates the sign: zero counts as positive, so signs are not equally
/// likely if many values are zero.
/// Threading: one thread.
class ByteModel {
 public:
  static constexpr size_t kContexts = 3;
  /// Number of classes of each context, see class_of().
  static constexpr size_t kClasses = 24;
  using Contexts = std::array<size_t, kContexts>;

  /// The class of a mean magnitude in 1/16, from 0 on. There are two classes per doubling.
  static size_t class_of(uint32_t sixteenths);

  ByteModel();

  /// Encodes `value`, or decodes and returns a value; any bits decode to one. `contexts` must be
  /// below kClasses.
  template <typename Port>
  int code(Port& port, const Contexts& contexts, int value);

 private:
  static constexpr size_t kWidths = 8;           ///< 0 to 7 bits.
  static constexpr size_t kNodes = 2 * kWidths;  ///< Trees of eight widths, one per sign.
  /// Nodes of a tree of the two bits below the first.
  static constexpr size_t kHigh = 4;
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
