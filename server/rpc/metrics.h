// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace engram::server {

/// How often something happened, since the start.
///
/// Threading: thread-safe, one atomic addition.
class Counter {
 public:
  void add(uint64_t count = 1) { count_.fetch_add(count, std::memory_order_relaxed); }
  [[nodiscard]] uint64_t value() const { return count_.load(std::memory_order_relaxed); }

 private:
  std::atomic<uint64_t> count_{0};
};

/// What something is right now.
///
/// Threading: thread-safe, without locks.
class Gauge {
 public:
  void set(double value) { value_.store(value, std::memory_order_relaxed); }
  void add(double change) { value_.fetch_add(change, std::memory_order_relaxed); }
  [[nodiscard]] double value() const { return value_.load(std::memory_order_relaxed); }

 private:
  std::atomic<double> value_{0};
};

/// How many of the numbers that were observed are at most each of some bounds, and their sum.
///
/// What is not finite is above all bounds and not in the sum, which would not recover from it.
/// Threading: thread-safe, without locks. Who reads while others observe may find a sum that
/// lacks numbers which are counted, or the other way round.
/// Complexity: observing is O(log(number of bounds)).
class Histogram {
 public:
  /// Needs bounds that are finite and increase strictly (checked).
  explicit Histogram(std::vector<double> bounds);

  void observe(double number);

  [[nodiscard]] const std::vector<double>& bounds() const { return bounds_; }

  /// Of each bound, how many are at most that; at last, of all.
  [[nodiscard]] std::vector<uint64_t> cumulative_counts() const;
  [[nodiscard]] double sum() const { return sum_.load(std::memory_order_relaxed); }

 private:
  const std::vector<double> bounds_;
  std::vector<std::atomic<uint64_t>> counts_;  ///< Between bounds; at last, above all.
  std::atomic<double> sum_{0};
};

/// Bounds of how long something takes that should be quick: 0.1 ms to 10 s. Unit: s.
[[nodiscard]] std::vector<double> latency_bounds();

}  // namespace engram::server
