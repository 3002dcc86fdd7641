// SPDX-License-Identifier: Apache-2.0
#include "training/quality/bd_rate.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace engram::training {

namespace {

/// A monotone piecewise cubic through points of increasing x.
class PiecewiseCubic {
 public:
  PiecewiseCubic(std::vector<double> x, std::vector<double> y)
      : x_(std::move(x)), y_(std::move(y)), slopes_(x_.size()) {
    const size_t n = x_.size();
    if (n == 2) {
      slopes_ = {secant(0), secant(0)};
      return;
    }
    for (size_t i = 1; i + 1 < n; ++i) slopes_[i] = inner_slope(i);
    slopes_[0] = end_slope(width(0), width(1), secant(0), secant(1));
    slopes_[n - 1] = end_slope(width(n - 2), width(n - 3), secant(n - 2), secant(n - 3));
  }

  [[nodiscard]] double integral(double from, double to) const {
    double sum = 0;
    for (size_t i = 0; i + 1 < x_.size(); ++i) {
      const double begin = std::max(from, x_[i]), end = std::min(to, x_[i + 1]);
      if (begin < end) sum += antiderivative(i, end - x_[i]) - antiderivative(i, begin - x_[i]);
    }
    return sum;
  }

 private:
  [[nodiscard]] double width(size_t i) const { return x_[i + 1] - x_[i]; }
  [[nodiscard]] double secant(size_t i) const { return (y_[i + 1] - y_[i]) / width(i); }

  /// Weighted harmonic mean of the slopes on both sides; zero if they differ in sign.
  [[nodiscard]] double inner_slope(size_t i) const {
    const double left = secant(i - 1), right = secant(i);
    if (left * right <= 0) return 0;
    const double a = 2 * width(i) + width(i - 1), b = width(i) + 2 * width(i - 1);
    return (a + b) / (a / left + b / right);
  }

  /// Slope of a parabola through three points, limited to keep the curve monotone.
  static double end_slope(double near_width, double far_width, double near, double far) {
    const double slope =
        ((2 * near_width + far_width) * near - near_width * far) / (near_width + far_width);
    if (slope * near <= 0) return 0;
    if (near * far <= 0 && std::abs(slope) > 3 * std::abs(near)) return 3 * near;
    return slope;
  }

  [[nodiscard]] double antiderivative(size_t i, double t) const {
    const double h = width(i), d = secant(i);
    const double c = (3 * d - 2 * slopes_[i] - slopes_[i + 1]) / h;
    const double b = (slopes_[i] - 2 * d + slopes_[i + 1]) / (h * h);
    return t * (y_[i] + t * (slopes_[i] / 2 + t * (c / 3 + t * b / 4)));
  }

  std::vector<double> x_, y_, slopes_;
};

Result<std::vector<RatePoint>> sorted(std::span<const RatePoint> curve) {
  std::vector<RatePoint> points(curve.begin(), curve.end());
  std::ranges::sort(points, {}, &RatePoint::psnr_db);
  if (points.size() < 2)
    return invalid_argument("BD-rate: curve of {} points, needs 2", points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    if (!(points[i].bytes > 0) || !std::isfinite(points[i].bytes + points[i].psnr_db))
      return invalid_argument("BD-rate: point of {} bytes at {} dB", points[i].bytes,
                              points[i].psnr_db);
    if (i > 0 && points[i].psnr_db <= points[i - 1].psnr_db)
      return invalid_argument("BD-rate: two points at {} dB", points[i].psnr_db);
  }
  return points;
}

// Differences of logarithms are ratios, so every quality counts equally, whatever bytes it needs.
PiecewiseCubic log_bytes(const std::vector<RatePoint>& points) {
  std::vector<double> quality, logs;
  for (const RatePoint& point : points) {
    quality.push_back(point.psnr_db);
    logs.push_back(std::log(point.bytes));
  }
  return {std::move(quality), std::move(logs)};
}

}  // namespace

Result<double> bd_rate(std::span<const RatePoint> reference, std::span<const RatePoint> curve) {
  ENGRAM_ASSIGN_OR_RETURN(const auto a, sorted(reference));
  ENGRAM_ASSIGN_OR_RETURN(const auto b, sorted(curve));
  const double from = std::max(a.front().psnr_db, b.front().psnr_db);
  const double to = std::min(a.back().psnr_db, b.back().psnr_db);
  if (from >= to)
    return invalid_argument("BD-rate: curves share no quality: from {} dB to {} dB", from, to);
  const double difference = log_bytes(b).integral(from, to) - log_bytes(a).integral(from, to);
  return std::exp(difference / (to - from)) - 1;
}

}  // namespace engram::training
