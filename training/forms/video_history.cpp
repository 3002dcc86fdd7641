// SPDX-License-Identifier: Apache-2.0
#include "training/forms/video_history.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ltm/core/check.h"

namespace engram::training {

namespace {

/// Bounds of a slope: beyond them a chain's quality did not follow crf, as where it is all black.
/// Unit: dB per step of crf.
constexpr double kMinSlope = 0.08, kMaxSlope = 2.0;
/// The same of bytes: logarithm per dB. Trials that are nearer to each other say too little.
constexpr double kMinRate = 0.05, kMaxRate = 1.0, kMinStepDb = 0.2;
/// How much of the level and of the slopes is the last chain's.
constexpr double kNewLevel = 0.5, kNewSlope = 0.25;
/// What a line that was read may say.
constexpr double kMaxCrf = 255, kMaxDb = 200;

/// The slope between two trials; nothing if they are of the same crf or say nothing.
double slope_between(const VideoTrial& a, const VideoTrial& b, double otherwise) {
  if (a.crf == b.crf) return otherwise;
  const double slope = (a.worst_db - b.worst_db) / (b.crf - a.crf);
  return std::isfinite(slope) && slope > 0 ? std::clamp(slope, kMinSlope, kMaxSlope) : otherwise;
}

/// The same of the logarithm of bytes per dB.
double bytes_per_db_between(const VideoTrial& a, const VideoTrial& b, double otherwise) {
  const double step_db = b.worst_db - a.worst_db;
  if (std::abs(step_db) < kMinStepDb || a.bytes == 0 || b.bytes == 0) return otherwise;
  const double rate =
      std::log(static_cast<double>(b.bytes) / static_cast<double>(a.bytes)) / step_db;
  return std::isfinite(rate) ? std::clamp(rate, kMinRate, kMaxRate) : otherwise;
}

}  // namespace

void VideoHistory::go_on_from(const Line& line) {
  const bool is_line = line.slope >= kMinSlope && line.slope <= kMaxSlope &&
                       std::abs(line.at_crf) <= kMaxCrf && std::abs(line.at_db) <= kMaxDb &&
                       line.bytes_per_db >= kMinRate && line.bytes_per_db <= kMaxRate;
  if (chains_ > 0 || !is_line) return;
  line_ = line;
  chains_ = 1;
}

int VideoHistory::first_guess(double bound_db, double tolerance_db) const {
  const double wanted_db = bound_db - tolerance_db / 2;
  return static_cast<int>(std::floor(line_.at_crf + (line_.at_db - wanted_db) / line_.slope));
}

double VideoHistory::change_to(double wanted_db, std::span<const VideoTrial> trials) const {
  ENGRAM_CHECK(!trials.empty(), "no trial to start from");
  const VideoTrial& last = trials.back();
  double slope = line_.slope;
  if (trials.size() > 1) slope = slope_between(trials[trials.size() - 2], last, line_.slope);
  return (last.worst_db - wanted_db) / slope;
}

void VideoHistory::learn(std::span<const VideoTrial> trials, double bound_db) {
  ENGRAM_CHECK(!trials.empty(), "a chain without a trial");
  encodes_.push_back(static_cast<uint8_t>(std::min<size_t>(trials.size(), 255)));
  const auto nearest = *std::ranges::min_element(
      trials, {}, [&](const VideoTrial& trial) { return std::abs(trial.worst_db - bound_db); });
  const auto adapt = [](double& known, double found) { known += kNewSlope * (found - known); };
  for (size_t i = 1; i < trials.size(); ++i) {
    const VideoTrial &before = trials[i - 1], &after = trials[i];
    adapt(line_.bytes_per_db, bytes_per_db_between(before, after, line_.bytes_per_db));
    adapt(line_.slope, slope_between(before, after, line_.slope));
  }
  const double crf = nearest.crf;
  const double expected_db = line_.at_db - line_.slope * (crf - line_.at_crf);
  const double error = nearest.worst_db - expected_db;
  line_.at_crf = crf;
  line_.at_db = chains_ == 0 ? nearest.worst_db : expected_db + kNewLevel * error;
  ++chains_;
}

}  // namespace engram::training
