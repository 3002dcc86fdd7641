// SPDX-License-Identifier: Apache-2.0
#include "training/fit/fit_global_code.h"

#include <algorithm>
#include <cmath>

#include "encoders/weight_rounding.h"

namespace engram::training {

using torch::Tensor;

namespace {

/// Side of the small images that codes are fitted to.
constexpr int64_t kSide = 8;
/// Ridge that is added to the variance of every pooled latent, relative to their mean variance.
constexpr double kRidge = 0.01;
constexpr int64_t kTogether = 64;

/// All images of a batch at kSide x kSide, scaled such that distances are root mean squares of grey
/// levels. Shape: [B, T].
Tensor small_images(const encoders::Parts& values) {
  std::vector<Tensor> small;
  for (const Tensor& image : values.images)
    small.push_back(torch::adaptive_avg_pool2d(image, {kSide, kSide}).contiguous().flatten(1));
  const Tensor all = torch::cat(small, 1);
  return all / std::sqrt(static_cast<double>(all.size(1)));
}

/// Moments of pooled latents x [n, F] and small images y [n, T], around the means of each
/// background.
struct Moments {
  Tensor count;           ///< [scenes, 1]
  Tensor mean_x, mean_y;  ///< [scenes, F], [scenes, T]
  Tensor within_x;        ///< Sum of outer products [F, F].
  Tensor within_xy;       ///< [F, T]
  Tensor total_mean_y;    ///< [1, T]
};

Moments moments_of(const encoders::DeepModel& model, const Dataset& data,
                   const LatentTable& latents) {
  const auto& shape = model.autoencoder->shape;
  const auto rows = static_cast<int64_t>(data.size());
  Moments m;
  for (int64_t first = 0; first < rows; first += kTogether) {
    const Tensor indices = torch::arange(first, std::min(first + kTogether, rows), torch::kLong);
    const auto z = latents.rows(indices);
    const Tensor x = encoders::pooled_latents(z).to(torch::kFloat64);
    const Tensor y = small_images(data.batch(shape, indices)).to(torch::kFloat64);
    const Tensor of_scene = torch::one_hot(z.scene, shape.sizes.scenes).to(torch::kFloat64).t();
    const auto add = [](Tensor& sum, const Tensor& term) {
      sum = sum.defined() ? sum + term : term;
    };
    add(m.count, of_scene.sum(1, true));
    add(m.mean_x, torch::matmul(of_scene, x));
    add(m.mean_y, torch::matmul(of_scene, y));
    add(m.within_x, torch::matmul(x.t(), x));
    add(m.within_xy, torch::matmul(x.t(), y));
  }
  m.total_mean_y = m.mean_y.sum(0, true) / static_cast<double>(rows);
  const Tensor present = m.count.clamp_min(1);
  m.mean_x = m.mean_x / present;
  m.mean_y = m.mean_y / present;
  m.within_x = m.within_x - torch::matmul(m.mean_x.t(), m.count * m.mean_x);
  m.within_xy = m.within_xy - torch::matmul(m.mean_x.t(), m.count * m.mean_y);
  return m;
}

/// The principal components with the largest variances, in falling order. Shape: [T, at most
/// kGlobalCodeSize].
Tensor principal_columns(const Tensor& covariance) {
  const Tensor columns = std::get<1>(torch::linalg_eigh(covariance)).flip(1);
  return columns.slice(1, 0, encoders::kGlobalCodeSize);
}

}  // namespace

void fit_global_code(encoders::DeepModel& model, const Dataset& data, const LatentTable& latents) {
  if (latents.images.empty()) return;
  torch::NoGradGuard no_grad;
  const Moments m = moments_of(model, data, latents);
  const int64_t features = m.within_x.size(0);
  const double ridge = kRidge * m.within_x.trace().item<double>() / static_cast<double>(features);
  const Tensor damped = m.within_x + torch::eye(features, torch::kFloat64) * (ridge + 1e-9);
  const Tensor weights = torch::linalg_solve(damped, m.within_xy);  // [F, T]
  const Tensor between = m.mean_y - m.total_mean_y;                 // [scenes, T]
  const Tensor explained = torch::matmul(weights.t(), torch::matmul(m.within_x, weights)) +
                           torch::matmul(between.t(), m.count * between);
  const Tensor columns = principal_columns(explained);  // [T, K]
  Tensor projection = torch::matmul(weights, columns).t().to(torch::kFloat32).contiguous();
  encoders::round_rows(projection);
  const Tensor from_latents = torch::matmul(m.mean_x, projection.to(torch::kFloat64).t());
  model.global_code.projection = projection;
  model.global_code.offset =
      (torch::matmul(between, columns) - from_latents).to(torch::kFloat32).contiguous();
}

}  // namespace engram::training
