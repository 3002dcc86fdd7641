// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "ltm/core/time.h"

namespace engram::training {

/// The progress of a fit, asked for once per step. A fit ends after a number of steps, after a time
/// of work, or at a moment.
///
/// Threading: one thread.
class Schedule {
 public:
  /// Ends after `steps` if given, else after `seconds`.
  Schedule(std::optional<int> steps, double seconds);

  /// Ends early enough before `end` to leave time for later parts. The time is divided between
  /// `weight` for this whole fit and `weight_after` for the later parts.
  Schedule(Time end, double weight, double weight_after, Clock clock = system_now);

  /// Continues from `share`, after a break or in a new process. The time since the last share
  /// counts only if the end is a moment.
  void go_on_from(double share);

  /// The share that is done, from 0 to 1 or more.
  [[nodiscard]] double share(int64_t step) const;
  /// Negative if unknown.
  [[nodiscard]] double seconds_left(int64_t step) const;

 private:
  [[nodiscard]] double elapsed() const;

  std::optional<int> steps_;
  double seconds_ = 0;  ///< Duration of a whole fit.
  std::optional<Time> end_;
  double weight_ = 1;
  double weight_after_ = 0;
  Clock clock_;
  double first_share_ = 0;
  double first_seconds_ = 0;  ///< Duration from first_share_ to the end.
  std::chrono::steady_clock::time_point start_;
};

/// Learning rate relative to its peak: a linear warm-up, then a cosine to nearly zero.
[[nodiscard]] double learning_rate_share(double share);

/// A mean over recent values.
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

/// The price of squared error in bytes. It rises while quality is below the requested one minus the
/// gain that training is expected to make by itself until its end.
class ErrorPrice {
 public:
  /// `first` is the price to start at, or 0 for the default.
  explicit ErrorPrice(double wanted_db, double first = 0);

  /// Price in kilobytes per squared grey level.
  [[nodiscard]] double value() const;

  /// Updates the price from the smoothed quality of a step and the share of the time that is over.
  void follow(double psnr_db, double share);

  /// Everything that changes, for checkpoints.
  [[nodiscard]] std::vector<double*> state() { return {&log_price_, &share_}; }

 private:
  double wanted_db_;
  double log_price_;
  double share_ = 0;
};

}  // namespace engram::training
