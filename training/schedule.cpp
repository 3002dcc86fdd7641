// SPDX-License-Identifier: Apache-2.0
#include "training/schedule.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "ltm/core/time.h"

namespace engram::training {

namespace {

/// What the price starts with, and where it stays between.
constexpr double kFirstPrice = 0.01;
constexpr double kLeastPrice = 1e-4;
constexpr double kMostPrice = 1.0;
/// Share of the time before the price moves.
constexpr double kSettling = 0.05;
/// How fast it moves where quality is off by one decibel: factors of e in the whole time.
constexpr double kSteering = 25.0;

}  // namespace

Schedule::Schedule(std::optional<int> steps, double seconds)
    : steps_(steps), seconds_(seconds), start_(std::chrono::steady_clock::now()) {}

double Schedule::share(int64_t step) const {
  if (steps_) return static_cast<double>(step) / std::max(*steps_, 1);
  return to_seconds(std::chrono::steady_clock::now() - start_) / seconds_;
}

double Schedule::seconds_left(int64_t step) const {
  const double elapsed = to_seconds(std::chrono::steady_clock::now() - start_);
  if (!steps_) return std::max(seconds_ - elapsed, 0.0);
  return step == 0 ? -1 : elapsed / static_cast<double>(step) * static_cast<double>(*steps_ - step);
}

double learning_rate_share(double share) {
  constexpr double kWarmUp = 0.02;
  constexpr double kLast = 0.005;
  const double warm = std::min(1.0, kLast + share / kWarmUp);
  return warm *
         (kLast + (1 - kLast) * 0.5 * (1 + std::cos(std::numbers::pi * std::min(share, 1.0))));
}

void Smoothed::add(double value) {
  value_ = is_empty_ ? value : value_ + share_of_new_ * (value - value_);
  is_empty_ = false;
}

ErrorPrice::ErrorPrice(double wanted_db)
    : wanted_db_(wanted_db), log_price_(std::log(kFirstPrice)) {}

double ErrorPrice::value() const {
  return std::exp(log_price_);
}

void ErrorPrice::follow(double psnr_db, double share) {
  const double passed = std::exchange(share_, share);
  if (share < kSettling) return;
  log_price_ += kSteering * (share - passed) * std::clamp(wanted_db_ - psnr_db, -1.0, 1.0);
  log_price_ = std::clamp(log_price_, std::log(kLeastPrice), std::log(kMostPrice));
}

}  // namespace engram::training
