// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include "encoders/coding/adaptive_bit.h"
#include "encoders/coding/logistic.h"

namespace engram::encoders {

/// An adaptive bit that keeps its log odds. They are looked up when it learns, so that mixing many
/// estimates needs no lookup.
///
/// Threading: one thread.
class OddsBit {
 public:
  OddsBit() = default;
  explicit OddsBit(const AdaptiveBit& bit)
      : bit_(bit), odds_(static_cast<int16_t>(log_odds(bit.one()))) {}

  [[nodiscard]] const AdaptiveBit& bit() const { return bit_; }
  [[nodiscard]] LogOdds odds() const { return odds_; }

  /// `table` is odds_table().
  void update(bool bit, const OddsTable& table) {
    bit_.update(bit);
    odds_ = table[bit_.mean()];
  }

 private:
  AdaptiveBit bit_;
  int16_t odds_ = 0;
};

}  // namespace engram::encoders
