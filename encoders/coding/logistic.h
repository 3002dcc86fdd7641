// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "encoders/coding/binary_coder.h"

namespace engram::encoders {

/// Natural logarithms of odds in units of 1/256, clamped to kMaxLogOdds in magnitude, so that a
/// probability is at least 6.2e-6.
using LogOdds = int32_t;
inline constexpr LogOdds kMaxLogOdds = 3071;

/// The table of squash(). It is made at compile time, so it is the same on every machine.
extern const std::array<uint16_t, 2 * kMaxLogOdds + 1> kProbabilityOf;

/// The probability of these odds, 16 to 65520 of 65536.
[[nodiscard]] inline BitProbability squash(LogOdds odds) {
  const LogOdds known = std::clamp(odds, -kMaxLogOdds, kMaxLogOdds);
  return kProbabilityOf[static_cast<size_t>(known + kMaxLogOdds)];
}

/// ln(p / (1 - p)) where p = part / (part + rest), with one added to each. Both must be below 2^40.
[[nodiscard]] LogOdds log_odds(uint64_t part, uint64_t rest);
[[nodiscard]] LogOdds log_odds(BitProbability one);

/// log_odds of AdaptiveBit::one(), indexed by its mean(). The table is made at the first call, in
/// about a millisecond.
using OddsTable = std::array<int16_t, 1 << kProbabilityBits>;
[[nodiscard]] const OddsTable& odds_table();

/// Share above `z` of a distribution around zero with a logistic core (7 of 8 parts) and wide
/// shoulders (four times as wide). `z` is in 1/32 of the scale of the core. The result is 2^31
/// times the share. It is never zero, and strictly falling up to |z| = 2048, then constant.
[[nodiscard]] uint32_t share_above(int64_t z);

/// 16 log2(value), exact to one step. `value` must be above 0 (checked).
[[nodiscard]] int32_t log2_sixteenths(uint64_t value);

/// 2^20 / 2^(exponent / 16). `exponent` is clamped to -160..320.
[[nodiscard]] int64_t inverse_power(int32_t exponent);

}  // namespace engram::encoders
