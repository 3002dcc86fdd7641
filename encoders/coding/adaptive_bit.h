// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "encoders/coding/binary_coder.h"

namespace engram::encoders {

/// Estimates how likely the next bit of one context is a one, from those before.
///
/// The mean of two estimates: one follows changes, the other holds still. Both start by counting,
/// so that the first few bits teach much.
/// Threading: one thread.
class AdaptiveBit {
 public:
  static constexpr int kFastRate = 6;  ///< A bit moves the estimate by 2^-rate of the way.
  static constexpr int kSlowRate = 7;

  AdaptiveBit() = default;
  /// Starts as if `seen` bits (at most 255) had taught it `one` (1 to 65535).
  AdaptiveBit(BitProbability one, int seen)
      : fast_(static_cast<uint16_t>(one)), slow_(fast_), seen_(static_cast<uint8_t>(seen)) {}

  [[nodiscard]] BitProbability one() const {
    return std::clamp<uint32_t>((uint32_t{fast_} + slow_) / 2, 32, 65536 - 32);
  }

  /// Bits that taught it, at most 255.
  [[nodiscard]] int seen() const { return seen_; }

  void update(bool bit) {
    const int32_t target = bit ? 65535 : 0;
    move(fast_, target, kFastRate);
    move(slow_, target, kSlowRate);
    if (seen_ < 255) ++seen_;
  }

  /// Codes a bit and learns from it.
  template <typename Port>
  bool code(Port& port, bool bit) {
    bit = port.code(bit, one());
    update(bit);
    return bit;
  }

 private:
  void move(uint16_t& estimate, int32_t target, int rate) const {
    const int32_t share = std::min(int32_t{seen_} + 2, int32_t{1} << rate);
    estimate = static_cast<uint16_t>(estimate + (target - estimate) / share);
  }

  uint16_t fast_ = 32768;
  uint16_t slow_ = 32768;
  uint8_t seen_ = 0;
};

}  // namespace engram::encoders
