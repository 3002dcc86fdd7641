// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/logistic.h"

#include <algorithm>
#include <array>
#include <bit>

#include "encoders/coding/adaptive_bit.h"
#include "ltm/core/check.h"

namespace engram::encoders {

namespace {

// The compiler makes these tables with additions, multiplications and divisions alone, which round
// in the same way everywhere; std::exp does not.

constexpr double exp_of(double x) {
  constexpr int kHalvings = 8;
  const double small = x / (1 << kHalvings);
  double term = 1, sum = 1;
  for (int i = 1; i < 12; ++i) {
    term *= small / i;
    sum += term;
  }
  for (int i = 0; i < kHalvings; ++i) sum *= sum;
  return sum;
}

constexpr size_t kTailEntries = 2049;

constexpr auto kTail = [] {
  std::array<uint32_t, kTailEntries> table{};
  for (size_t i = 0; i < kTailEntries; ++i) {
    const double z = static_cast<double>(i) / 32.0;
    const double core = 1.0 / (1.0 + exp_of(z)), wide = 1.0 / (1.0 + exp_of(z / 4));
    // The ramp keeps the table strictly falling.
    const double ramp = static_cast<double>(kTailEntries - 1 - i) * 16 + 1024;
    table[i] =
        static_cast<uint32_t>((2147483648.0 - 131072.0) * (0.875 * core + 0.125 * wide) + ramp);
  }
  return table;
}();

// Logarithms come from a table of ln over [1, 2) in steps of 1/256.
constexpr size_t kLogBits = 8;
constexpr double ln_of(double x) {  // x in [1, 2]
  const double t = (x - 1) / (x + 1);
  double power = t, sum = 0;
  for (int i = 1; i < 30; i += 2) {
    sum += power / i;
    power *= t * t;
  }
  return 2 * sum;
}
constexpr double kLn2 = ln_of(2.0);

constexpr auto kLn = [] {  // 256 * 256 * ln(1 + i / 256)
  std::array<int32_t, (1 << kLogBits) + 1> table{};
  for (size_t i = 0; i < table.size(); ++i)
    table[i] = static_cast<int32_t>(65536.0 * ln_of(1.0 + static_cast<double>(i) / 256.0) + 0.5);
  return table;
}();

/// 65536 ln(value), value > 0.
int64_t ln_65536(uint64_t value) {
  const int width = std::bit_width(value);
  const uint64_t top = width > 17 ? value >> (width - 17) : value << (17 - width);  // 17 bits
  const auto index = static_cast<size_t>((top >> 8) & 0xff);
  const auto fraction = static_cast<int64_t>(top & 0xff);
  const int64_t low = kLn[index], high = kLn[index + 1];
  constexpr auto kWidth = static_cast<int64_t>(65536.0 * kLn2 + 0.5);
  return (width - 1) * kWidth + low + (high - low) * fraction / 256;
}

constexpr auto kInverse = [] {  // 2^20 * 2^(-i / 16) for i in [0, 16)
  std::array<int64_t, 16> table{};
  for (size_t i = 0; i < table.size(); ++i)
    table[i] = static_cast<int64_t>(1048576.0 * exp_of(-kLn2 * static_cast<double>(i) / 16) + 0.5);
  return table;
}();

// Distance in units of the computed values; values between are interpolated linearly.
constexpr int kOddsStep = 8;

}  // namespace

constexpr std::array<uint16_t, 2 * kMaxLogOdds + 1> kProbabilityOf = [] {
  const auto at = [](int32_t steps) {
    const double odds = (static_cast<double>(steps) * kOddsStep - (kMaxLogOdds + 1)) / 256.0;
    return static_cast<int32_t>(65536.0 / (1.0 + exp_of(-odds)));
  };
  std::array<uint16_t, 2 * kMaxLogOdds + 1> table{};
  int32_t step = 0, low = at(0), high = at(1);
  for (int32_t i = 1; i <= 2 * kMaxLogOdds + 1; ++i) {
    if (i / kOddsStep != step) {
      step = i / kOddsStep;
      low = high;
      high = at(step + 1);
    }
    const int32_t value = low + (high - low) * (i % kOddsStep) / kOddsStep;
    table[static_cast<size_t>(i) - 1] = static_cast<uint16_t>(std::clamp(value, 16, 65536 - 16));
  }
  return table;
}();

LogOdds log_odds(uint64_t part, uint64_t rest) {
  const int64_t odds = (ln_65536(part + 1) - ln_65536(rest + 1)) / 256;
  return static_cast<LogOdds>(std::clamp<int64_t>(odds, -kMaxLogOdds, kMaxLogOdds));
}

LogOdds log_odds(BitProbability one) {
  return log_odds(uint64_t{one}, uint64_t{65536 - one});
}

const OddsTable& odds_table() {
  static const OddsTable table = [] {
    OddsTable made{};
    for (BitProbability mean = 0; mean < made.size(); ++mean)
      made[mean] = static_cast<int16_t>(
          log_odds(std::clamp(mean, AdaptiveBit::kMin, 65536 - AdaptiveBit::kMin)));
    return made;
  }();
  return table;
}

uint32_t share_above(int64_t z) {
  const auto at = static_cast<size_t>(std::min<int64_t>(z < 0 ? -z : z, kTailEntries - 1));
  return z < 0 ? (1u << 31) - kTail[at] : kTail[at];
}

int32_t log2_sixteenths(uint64_t value) {
  ENGRAM_CHECK(value > 0, "logarithm of zero");
  constexpr auto kSixteenth = static_cast<int64_t>(65536.0 * kLn2 / 16 + 0.5);
  return static_cast<int32_t>(ln_65536(value) / kSixteenth);
}

int64_t inverse_power(int32_t exponent) {
  exponent = std::clamp(exponent, -160, 320);
  const int32_t whole = exponent >= 0 ? exponent / 16 : -((15 - exponent) / 16);
  const int64_t mantissa = kInverse[static_cast<size_t>(exponent - 16 * whole)];
  return whole >= 0 ? mantissa >> whole : mantissa << -whole;
}

}  // namespace engram::encoders
