// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace engram::server {

/// Counts how often something happened since the start.
///
/// Threading: thread-safe; counting is one atomic addition.
class Counter {
 public:
  void add(uint64_t count = 1) { count_.fetch_add(count, std::memory_order_relaxed); }
  [[nodiscard]] uint64_t value() const { return count_.load(std::memory_order_relaxed); }

 private:
  std::atomic<uint64_t> count_{0};
};

/// A value that can rise and fall.
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

/// Counts how many observed numbers are at or below each of some bounds, and sums them.
///
/// A number that is not finite counts as above all bounds and is left out of the sum, which could
/// not recover from it.
/// Threading: thread-safe, without locks. A reader may see a sum that lacks numbers already
/// counted, or includes numbers not yet counted, while others observe.
/// Complexity: observing is O(log(number of bounds)).
class Histogram {
 public:
  /// Needs bounds that are finite and strictly increasing (checked).
  explicit Histogram(std::vector<double> bounds);

  void observe(double number);

  [[nodiscard]] const std::vector<double>& bounds() const { return bounds_; }

  /// Returns for each bound how many numbers are at or below it, followed by the count of all.
  [[nodiscard]] std::vector<uint64_t> cumulative_counts() const;
  [[nodiscard]] double sum() const { return sum_.load(std::memory_order_relaxed); }

 private:
  const std::vector<double> bounds_;
  /// One per interval between bounds; the last counts what is above all bounds.
  std::vector<std::atomic<uint64_t>> counts_;
  std::atomic<double> sum_{0};
};

/// Bounds for latencies of operations that should be quick: 0.1 ms to 10 s. Unit: s.
[[nodiscard]] std::vector<double> latency_bounds();

}  // namespace engram::server
