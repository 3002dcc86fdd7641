// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <array>
#include <cstddef>
#include <vector>

#include "encoders/coding/mixer.h"
#include "encoders/coding/odds_bit.h"

namespace engram::encoders {

/// Codes bits of one kind, each estimated by N contexts. A mixer combines the estimates by their
/// log odds, and all of them learn from every bit.
///
/// Threading: one thread.
template <size_t N>
class MixedBits {
 public:
  using Contexts = std::array<size_t, N>;

  /// `sizes` is the number of values of each context.
  MixedBits(const Contexts& sizes, size_t mixers) : odds_(odds_table()), mixers_(mixers) {
    for (size_t i = 0; i < N; ++i) estimates_[i].resize(sizes[i]);
  }

  /// Codes a bit. `contexts` and `mixer` must be below their sizes.
  template <typename Port>
  bool code(Port& port, const Contexts& contexts, size_t mixer, bool bit) {
    std::array<LogOdds, N + 1> odds{};
    for (size_t i = 0; i < N; ++i) odds[i] = estimates_[i][contexts[i]].odds();
    odds[N] = kBias;
    const BitProbability one = mixers_[mixer].mix(odds);
    bit = port.code(bit, one);
    mixers_[mixer].update(odds, one, bit, kMixerRate);
    for (size_t i = 0; i < N; ++i) estimates_[i][contexts[i]].update(bit, odds_);
    return bit;
  }

 private:
  static constexpr LogOdds kBias = 256;
  static constexpr int kMixerRate = 14;

  const OddsTable& odds_;
  std::array<std::vector<OddsBit>, N> estimates_;
  std::vector<Mixer<N + 1>> mixers_;
};

}  // namespace engram::encoders
