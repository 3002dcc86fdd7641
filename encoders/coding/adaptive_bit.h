// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "encoders/coding/binary_coder.h"

namespace engram::encoders {

/// Estimates the probability that the next bit of one context is a one from the bits before it.
///
/// The estimate is the mean of two: one adapts fast, the other slowly. Both start by counting, so
/// that the first bits have a large effect.
/// Threading: one thread.
class AdaptiveBit {
 public:
  static constexpr int kFastRate = 6;  ///< A bit moves the estimate by 2^-rate of the distance.
  static constexpr int kSlowRate = 7;
  static constexpr BitProbability kMin = 32;  ///< Min probability of either bit.

  AdaptiveBit() = default;
  /// Starts as if it had learned the probability `one` (1 to 65535) from `seen` bits (at most 255).
  AdaptiveBit(BitProbability one, int seen)
      : fast_(static_cast<uint16_t>(one)), slow_(fast_), seen_(static_cast<uint8_t>(seen)) {}

  [[nodiscard]] BitProbability one() const {
    return std::clamp<uint32_t>(mean(), kMin, 65536 - kMin);
  }

  /// one() before it is clamped: 0 to 65535.
  [[nodiscard]] uint32_t mean() const { return (uint32_t{fast_} + slow_) / 2; }

  /// Number of bits that it learned from, at most 255.
  [[nodiscard]] int seen() const { return seen_; }

  void update(bool bit) {
    const Inverses& shares = kShares[seen_];
    move(fast_, bit, shares.fast);
    move(slow_, bit, shares.slow);
    seen_ = static_cast<uint8_t>(seen_ + (seen_ < 255 ? 1 : 0));
  }

  /// Codes a bit and learns from it.
  template <typename Port>
  bool code(Port& port, bool bit) {
    bit = port.code(bit, one());
    update(bit);
    return bit;
  }

 private:
  /// Products with an inverse of this many bits, rounded up, replace divisions. They are exact for
  /// numbers below 2^16 and divisors of up to 2^7.
  static constexpr int kInverseBits = 23;
  struct Inverses {
    uint32_t fast, slow;
  };
  /// Inverses of the divisors of a move, indexed by the number of bits seen before.
  static constexpr auto kShares = [] {
    const auto inverse = [](size_t seen, int rate) {
      const auto share = std::min(static_cast<uint32_t>(seen) + 2, 1u << rate);
      return ((1u << kInverseBits) + share - 1) / share;
    };
    std::array<Inverses, 256> shares{};
    for (size_t seen = 0; seen < shares.size(); ++seen)
      shares[seen] = {inverse(seen, kFastRate), inverse(seen, kSlowRate)};
    return shares;
  }();

  static void move(uint16_t& estimate, bool bit, uint32_t inverse) {
    // The distance to a one is the mirrored distance to a zero.
    const uint32_t flip = bit ? 0xffff : 0;
    const uint32_t way = estimate ^ flip;
    const auto step = static_cast<uint32_t>((uint64_t{way} * inverse) >> kInverseBits);
    estimate = static_cast<uint16_t>((way - step) ^ flip);
  }

  uint16_t fast_ = 32768;
  uint16_t slow_ = 32768;
  uint8_t seen_ = 0;
};

}  // namespace engram::encoders
