// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace engram::training {

/// How far a fit is, asked once per step: it ends by time or by number of steps.
///
/// Threading: one thread.
class Schedule {
 public:
  /// Ends after `steps` where given, else after `seconds`.
  Schedule(std::optional<int> steps, double seconds);

  /// The share that is done, 0 to 1.
  [[nodiscard]] double share(int64_t step) const;
  [[nodiscard]] double seconds_left(int64_t step) const;

 private:
  std::optional<int> steps_;
  double seconds_;
  std::chrono::steady_clock::time_point start_;
};

/// Learning rate relative to its peak: rises for a start, then falls as a cosine to nearly zero.
[[nodiscard]] double learning_rate_share(double share);

/// A mean over some recent values.
class Smoothed {
 public:
  explicit Smoothed(double share_of_new) : share_of_new_(share_of_new) {}
  void add(double value);
  [[nodiscard]] double value() const { return value_; }

 private:
  double share_of_new_;
  double value_ = 0;
  bool is_empty_ = true;
};

/// The price of squared error against bytes: rises where quality is below what was asked for.
class ErrorPrice {
 public:
  explicit ErrorPrice(double wanted_db);

  /// Kilobytes that a squared grey level is worth.
  [[nodiscard]] double value() const;

  /// Told the smoothed quality of every step, and how much of the time is over.
  void follow(double psnr_db, double share);

 private:
  double wanted_db_;
  double log_price_;
  double share_ = 0;
};

}  // namespace engram::training
