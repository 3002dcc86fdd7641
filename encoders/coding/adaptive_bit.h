// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
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
  static constexpr BitProbability kMin = 32;  ///< No estimate is nearer to certain.

  AdaptiveBit() = default;
  /// Starts as if `seen` bits (at most 255) had taught it `one` (1 to 65535).
  AdaptiveBit(BitProbability one, int seen)
      : fast_(static_cast<uint16_t>(one)), slow_(fast_), seen_(static_cast<uint8_t>(seen)) {}

  [[nodiscard]] BitProbability one() const {
    return std::clamp<uint32_t>(mean(), kMin, 65536 - kMin);
  }

  /// one() before it is clamped: 0 to 65535.
  [[nodiscard]] uint32_t mean() const { return (uint32_t{fast_} + slow_) / 2; }

  /// Bits that taught it, at most 255.
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
  /// Numbers below 2^16 are divided by up to 2^7 as products, exactly: this many bits of an
  /// inverse, rounded up, are enough.
  static constexpr int kInverseBits = 23;
  struct Inverses {
    uint32_t fast, slow;
  };
  /// The inverse of the share of the way that a bit moves an estimate, by the bits seen before.
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
    const uint32_t flip = bit ? 0xffff : 0;  // The way to a one is that to a zero, mirrored.
    const uint32_t way = estimate ^ flip;
    const auto step = static_cast<uint32_t>((uint64_t{way} * inverse) >> kInverseBits);
    estimate = static_cast<uint16_t>((way - step) ^ flip);
  }

  uint16_t fast_ = 32768;
  uint16_t slow_ = 32768;
  uint8_t seen_ = 0;
};

}  // namespace engram::encoders
