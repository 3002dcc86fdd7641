// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "encoders/torch.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Divergence of a Gaussian from the unit Gaussian, per element:
///
///     (exp(log_variance) + mean^2 - 1 - log_variance) / 2
///
/// Unit: nats. Shape: any; `log_variance` is broadcast.
/// Source: Kingma and Welling, Auto-Encoding Variational Bayes, appendix B.
[[nodiscard]] torch::Tensor gaussian_divergence(const torch::Tensor& mean,
                                                const torch::Tensor& log_variance);

/// Squared maximum mean discrepancy of two samples: 0 for equal samples, at most 2. The kernel is
/// the mean over scales s of C s / (C s + |a - b|^2). C = 2 K is the mean squared distance of two
/// samples of a unit Gaussian.
///
/// Shape: x [n, K], y [m, K]; the result is one number. Diagonals are included, so it is never
/// negative.
/// Source: Tolstikhin et al., Wasserstein Auto-Encoders, section 4.
[[nodiscard]] torch::Tensor mean_discrepancy(const torch::Tensor& x, const torch::Tensor& y);

}  // namespace engram::training
