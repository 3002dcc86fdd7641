// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace engram::datasets::kitchen {

/// Random numbers that do not depend on the standard library.
class Random {
 public:
  explicit Random(uint64_t seed) : engine_(seed * 0x9E3779B97F4A7C15u + 1) {}

  /// Uniform in [low, high).
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  size_t below(size_t count) { return engine_() % count; }
  bool chance(double probability) { return between(0, 1) < probability; }

  template <typename T>
  void shuffle(std::vector<T>& values) {
    for (size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[below(i)]);
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace engram::datasets::kitchen
