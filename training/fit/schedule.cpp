// SPDX-License-Identifier: Apache-2.0
#include "training/fit/schedule.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace engram::training {

namespace {

/// First value of the price, and its bounds.
constexpr double kFirstPrice = 0.003;
constexpr double kMinPrice = 1e-4;
constexpr double kMaxPrice = 1.0;
/// Share of the time before the price moves.
constexpr double kSettling = 0.05;
/// Speed of the price per decibel of difference: factors of e in the whole time.
constexpr double kSteering = 25.0;
/// Expected gain of quality per doubling of the time of training, and by the falling rate at its
/// end. Unit: decibels.
constexpr double kGainOfDoubling = 1.2;
constexpr double kGainOfEnd = 1.0;

}  // namespace

Schedule::Schedule(std::optional<int> steps, double seconds) : steps_(steps), seconds_(seconds) {
  go_on_from(0);
}

Schedule::Schedule(Time end, double weight, double weight_after, Clock clock)
    : end_(end), weight_(weight), weight_after_(weight_after), clock_(std::move(clock)) {
  go_on_from(0);
}

void Schedule::go_on_from(double share) {
  start_ = std::chrono::steady_clock::now();
  first_share_ = std::min(share, 1.0);
  first_seconds_ = seconds_ * (1 - first_share_);
  if (!end_) return;
  const double weight = weight_ * (1 - first_share_);
  first_seconds_ = to_seconds(*end_ - clock_()) * weight / std::max(weight + weight_after_, 1e-9);
}

double Schedule::elapsed() const {
  return to_seconds(std::chrono::steady_clock::now() - start_);
}

double Schedule::share(int64_t step) const {
  if (steps_) return static_cast<double>(step) / std::max(*steps_, 1);
  if (first_seconds_ <= 0) return 1;
  return first_share_ + (1 - first_share_) * elapsed() / first_seconds_;
}

double Schedule::seconds_left(int64_t step) const {
  if (!steps_) return std::max(first_seconds_ - elapsed(), 0.0);
  const double now = share(step);
  return now > first_share_ ? elapsed() / (now - first_share_) * (1 - now) : -1;
}

double learning_rate_share(double share) {
  constexpr double kWarmUp = 0.02;
  constexpr double kLast = 0.005;
  const double warm = std::min(1.0, kLast + share / kWarmUp);
  return warm *
         (kLast + (1 - kLast) * 0.5 * (1 + std::cos(std::numbers::pi * std::min(share, 1.0))));
}

void Smoothed::add(double value) {
  value_ = count_ == 0 ? value : value_ + share_of_new_ * (value - value_);
  ++count_;
}

ErrorPrice::ErrorPrice(double wanted_db, double first)
    : wanted_db_(wanted_db),
      log_price_(std::log(first > 0 ? std::clamp(first, kMinPrice, kMaxPrice) : kFirstPrice)) {}

double ErrorPrice::value() const {
  return std::exp(log_price_);
}

void ErrorPrice::follow(double psnr_db, double share) {
  const double passed = std::exchange(share_, share);
  if (share < kSettling) return;
  const double to_come = kGainOfDoubling * std::log2(1 / std::min(share, 1.0)) +
                         kGainOfEnd * (1 - std::min(share, 1.0));
  const double missing = wanted_db_ - to_come - psnr_db;
  log_price_ += kSteering * (share - passed) * std::clamp(missing, -1.0, 1.0);
  log_price_ = std::clamp(log_price_, std::log(kMinPrice), std::log(kMaxPrice));
}

}  // namespace engram::training
