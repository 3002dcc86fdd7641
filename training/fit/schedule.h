// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "ltm/core/time.h"

namespace engram::training {

/// How far a fit is, asked once per step: it ends by number of steps, by time that it works, or at
/// a moment.
///
/// Threading: one thread.
class Schedule {
 public:
  /// Ends after `steps` where given, else after `seconds`.
  Schedule(std::optional<int> steps, double seconds);

  /// Ends at a moment that leaves what follows its part of the time until `end`: a whole fit like
  /// this one counts as `weight`, what follows as `weight_after`.
  Schedule(Time end, double weight, double weight_after, Clock clock = system_now);

  /// From now on it goes from `share` on: after a break, or where an earlier process was. Time that
  /// passed since the last share counts only where the end is a moment.
  void go_on_from(double share);

  /// The share that is done, 0 to 1 and more.
  [[nodiscard]] double share(int64_t step) const;
  /// Negative where nobody knows.
  [[nodiscard]] double seconds_left(int64_t step) const;

 private:
  [[nodiscard]] double elapsed() const;

  std::optional<int> steps_;
  double seconds_ = 0;  ///< Of a whole fit.
  std::optional<Time> end_;
  double weight_ = 1;
  double weight_after_ = 0;
  Clock clock_;
  double first_share_ = 0;
  double first_seconds_ = 0;  ///< From first_share_ to the end.
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

  /// Everything that changes, for checkpoints.
  [[nodiscard]] std::vector<double*> state() { return {&value_, &count_}; }

 private:
  double share_of_new_;
  double value_ = 0;
  double count_ = 0;
};

/// The price of squared error against bytes: rises where quality is below what was asked for, less
/// what training is expected to gain by itself until its end.
class ErrorPrice {
 public:
  /// `first`: what it starts at, where that is known; 0: it is not.
  explicit ErrorPrice(double wanted_db, double first = 0);

  /// Kilobytes that a squared grey level is worth.
  [[nodiscard]] double value() const;

  /// Told the smoothed quality of every step, and how much of the time is over.
  void follow(double psnr_db, double share);

  /// Everything that changes, for checkpoints.
  [[nodiscard]] std::vector<double*> state() { return {&log_price_, &share_}; }

 private:
  double wanted_db_;
  double log_price_;
  double share_ = 0;
};

}  // namespace engram::training
