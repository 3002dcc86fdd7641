// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "encoders/coding/logistic.h"

namespace engram::encoders {

/// Combines several estimates of one bit into one: a weighted sum of their log odds, whose weights
/// learn from every bit. This is a small neural network in integers.
///
/// Threading: one thread.
/// Source: Mahoney, "Adaptive Weighing of Context Models for Lossless Data Compression", 2005.
template <size_t N>
class Mixer {
 public:
  using Weights = std::array<int16_t, N>;  ///< In 1/4096.
  static constexpr int kWeightBits = 12;

  Mixer() { weights_.fill(static_cast<int32_t>((1 << 16) / N)); }
  explicit Mixer(const Weights& start) {
    for (size_t i = 0; i < N; ++i) weights_[i] = int32_t{start[i]} * 16;
  }

  [[nodiscard]] Weights weights() const {
    Weights result{};
    for (size_t i = 0; i < N; ++i)
      result[i] = static_cast<int16_t>(std::clamp(weights_[i] / 16, -32768, 32767));
    return result;
  }

  /// The magnitude of each of `odds` must be at most kMaxLogOdds.
  [[nodiscard]] BitProbability mix(std::span<const LogOdds, N> odds) const {
    int64_t sum = 0;
    for (size_t i = 0; i < N; ++i) sum += int64_t{odds[i]} * weights_[i];
    return squash(
        static_cast<LogOdds>(std::clamp<int64_t>(sum / 65536, -kMaxLogOdds, kMaxLogOdds)));
  }

  /// `one` is the result of mix() for `odds`. The learning rate is 2^-rate.
  void update(std::span<const LogOdds, N> odds, BitProbability one, bool bit, int rate) {
    // The error is below 2^16 and odds are below 2^12, so 32 bits hold the product.
    const int32_t error = (bit ? 65535 : 0) - static_cast<int32_t>(one);
    for (size_t i = 0; i < N; ++i) {
      const int32_t change = (odds[i] * error) >> rate;
      weights_[i] = std::clamp(weights_[i] + change, -(1 << 19), (1 << 19) - 1);
    }
  }

 private:
  std::array<int32_t, N> weights_{};  ///< In 1/65536.
};

}  // namespace engram::encoders
