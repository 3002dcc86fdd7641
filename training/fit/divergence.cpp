// SPDX-License-Identifier: Apache-2.0
#include "training/fit/divergence.h"

#include <array>

namespace engram::training {

using torch::Tensor;

namespace {

constexpr std::array kScales{0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0};

/// Mean of the kernel over all pairs of samples.
Tensor mean_kernel(const Tensor& x, const Tensor& y) {
  const Tensor dot = torch::matmul(x, y.t());
  const Tensor squares = x.square().sum(1).unsqueeze(1) + y.square().sum(1).unsqueeze(0);
  const Tensor distance = (squares - 2.0 * dot).clamp_min(0);  // [n, m]
  Tensor sum = torch::zeros({}, x.options());
  for (const double scale : kScales) {
    const double c = 2.0 * static_cast<double>(x.size(1)) * scale;
    sum = sum + (c / (c + distance)).mean();
  }
  return sum / static_cast<double>(kScales.size());
}

}  // namespace

Tensor gaussian_divergence(const Tensor& mean, const Tensor& log_variance) {
  return 0.5 * (log_variance.exp() + mean.square() - 1.0 - log_variance);
}

Tensor mean_discrepancy(const Tensor& x, const Tensor& y) {
  return mean_kernel(x, x) + mean_kernel(y, y) - 2.0 * mean_kernel(x, y);
}

}  // namespace engram::training
