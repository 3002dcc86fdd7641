// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace engram::augmentation {

/// Mixes a number so that every bit of it affects all 64 bits of the result.
/// Source: Steele, Lea and Flood, "Fast Splittable Pseudorandom Number Generators", 2014.
[[nodiscard]] constexpr uint64_t spread(uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// Random number `index` of the sequence with this seed. It can be computed without those before.
[[nodiscard]] constexpr uint64_t random_at(uint64_t seed, uint64_t index) {
  constexpr uint64_t kStep = 0x9e3779b97f4a7c15ULL;
  return spread(seed + (index + 1) * kStep);
}

/// A sequence of random numbers that is the same on every machine, because it uses only integers.
///
/// Threading: one thread.
class Random {
 public:
  explicit constexpr Random(uint64_t seed) : seed_(seed) {}

  constexpr uint64_t next() { return random_at(seed_, count_++); }

  /// Draws from [min, max]; `min` must not exceed `max`. Uniform up to 2^-32 of the range.
  constexpr int64_t between(int64_t min, int64_t max) {
    const auto count = static_cast<uint64_t>(max - min) + 1;
    if (count > (uint64_t{1} << 32)) return min + static_cast<int64_t>(next() % count);
    return min + static_cast<int64_t>(((next() >> 32) * count) >> 32);
  }

 private:
  uint64_t seed_;
  uint64_t count_ = 0;
};

}  // namespace engram::augmentation
