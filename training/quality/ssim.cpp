// SPDX-License-Identifier: Apache-2.0
#include "training/quality/ssim.h"

#include <array>
#include <cmath>
#include <vector>

namespace engram::training {

namespace {

constexpr size_t kWindow = 11;
constexpr double kSigma = 1.5;
constexpr double kC1 = (0.01 * 255) * (0.01 * 255);
constexpr double kC2 = (0.03 * 255) * (0.03 * 255);

/// One channel of an image, row by row.
struct Plane {
  size_t height = 0, width = 0;
  std::vector<double> values;
};

std::array<double, kWindow> gaussian() {
  std::array<double, kWindow> weights{};
  double sum = 0;
  for (size_t i = 0; i < kWindow; ++i) {
    const double x = static_cast<double>(i) - (kWindow - 1) / 2;
    sum += weights[i] = std::exp(-x * x / (2 * kSigma * kSigma));
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

/// Weighted means along rows, then along columns: a Gaussian window is separable. Positions at
/// which the window does not fit are left out.
Plane blur(const Plane& plane) {
  static const std::array<double, kWindow> weights = gaussian();
  Plane rows{plane.height, plane.width - kWindow + 1, {}};
  for (size_t y = 0; y < rows.height; ++y)
    for (size_t x = 0; x < rows.width; ++x) {
      double sum = 0;
      for (size_t i = 0; i < kWindow; ++i)
        sum += weights[i] * plane.values[y * plane.width + x + i];
      rows.values.push_back(sum);
    }
  Plane both{plane.height - kWindow + 1, rows.width, {}};
  for (size_t y = 0; y < both.height; ++y)
    for (size_t x = 0; x < both.width; ++x) {
      double sum = 0;
      for (size_t i = 0; i < kWindow; ++i)
        sum += weights[i] * rows.values[(y + i) * rows.width + x];
      both.values.push_back(sum);
    }
  return both;
}

Plane channel_of(const idf::NdArray& image, size_t channel) {
  Plane plane{static_cast<size_t>(image.shape()[0]), static_cast<size_t>(image.shape()[1]), {}};
  const auto pixels = image.values<uint8_t>();
  const auto channels = static_cast<size_t>(image.shape()[2]);
  for (size_t i = channel; i < pixels.size(); i += channels) plane.values.push_back(pixels[i]);
  return plane;
}

Plane product(const Plane& a, const Plane& b) {
  Plane result = a;
  for (size_t i = 0; i < a.values.size(); ++i) result.values[i] *= b.values[i];
  return result;
}

double ssim_of(const Plane& a, const Plane& b) {
  const Plane mean_a = blur(a), mean_b = blur(b);
  const Plane aa = blur(product(a, a)), bb = blur(product(b, b)), ab = blur(product(a, b));
  double sum = 0;
  for (size_t i = 0; i < aa.values.size(); ++i) {
    const double ma = mean_a.values[i], mb = mean_b.values[i];
    const double variances = aa.values[i] - ma * ma + bb.values[i] - mb * mb;
    const double covariance = ab.values[i] - ma * mb;
    sum += (2 * ma * mb + kC1) * (2 * covariance + kC2) /
           ((ma * ma + mb * mb + kC1) * (variances + kC2));
  }
  return sum / static_cast<double>(aa.values.size());
}

}  // namespace

Result<double> ssim(const idf::NdArray& recorded, const idf::NdArray& other) {
  const idf::Shape& shape = recorded.shape();
  if (recorded.type() != idf::ElementType::kUInt8 || shape.size() != 3 ||
      shape[0] < static_cast<int64_t>(kWindow) || shape[1] < static_cast<int64_t>(kWindow) ||
      shape[2] < 1 || other.type() != recorded.type() || other.shape() != shape)
    return invalid_argument("SSIM: {} {} beside {} {}, needs two uint8 [H, W, C] of {} and more",
                            idf::to_string(recorded.type()), idf::to_string(shape),
                            idf::to_string(other.type()), idf::to_string(other.shape()), kWindow);
  double sum = 0;
  for (size_t channel = 0; channel < static_cast<size_t>(shape[2]); ++channel)
    sum += ssim_of(channel_of(recorded, channel), channel_of(other, channel));
  return sum / static_cast<double>(shape[2]);
}

}  // namespace engram::training
