// SPDX-License-Identifier: Apache-2.0
#include "encoders/dynamics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace engram::encoders {
namespace {

using torch::Tensor;

/// On both sides of half a step, far into the tail, narrow and wide.
const std::vector<double> kDistances{0.03, 0.2, 0.41, 0.6, 0.9, 1.7, 3.2, 6.5};
const std::vector<double> kLogScales{-1.2, -0.4, 0.0, 0.7, 1.9};

double bits_at(double distance, double log_scale) {
  return laplace_bits(torch::tensor(distance, torch::kFloat64),
                      torch::tensor(log_scale, torch::kFloat64).exp())
      .item<double>();
}

TEST(LaplaceBits, ArePaidByProbabilitiesThatAddUpToOne) {
  for (const double mean : {0.0, 0.3, -0.45})
    for (const double log_scale : kLogScales) {
      double sum = 0;
      for (int z = -200; z <= 200; ++z) sum += std::exp2(-bits_at(std::abs(z - mean), log_scale));
      // What is least probable counts as 1e-7.
      EXPECT_NEAR(sum, 1, 1e-4) << mean << ' ' << log_scale;
    }
}

TEST(LaplaceBits, HaveTheGradientOfFiniteDifferences) {
  constexpr double kStep = 1e-5;
  for (const double distance : kDistances)
    for (const double log_scale : kLogScales) {
      // Where the least probability counts there is none.
      if (bits_at(distance, log_scale) > 20) continue;
      const Tensor d = torch::tensor(distance, torch::dtype(torch::kFloat64).requires_grad(true));
      const Tensor s = torch::tensor(log_scale, torch::dtype(torch::kFloat64).requires_grad(true));
      laplace_bits(d, s.exp()).backward();
      const double by_distance =
          (bits_at(distance + kStep, log_scale) - bits_at(distance - kStep, log_scale)) /
          (2 * kStep);
      const double by_scale =
          (bits_at(distance, log_scale + kStep) - bits_at(distance, log_scale - kStep)) /
          (2 * kStep);
      EXPECT_NEAR(d.grad().item<double>(), by_distance, 1e-5 * (1 + std::abs(by_distance)))
          << distance << ' ' << log_scale;
      EXPECT_NEAR(s.grad().item<double>(), by_scale, 1e-5 * (1 + std::abs(by_scale)))
          << distance << ' ' << log_scale;
    }
}

}  // namespace
}  // namespace engram::encoders
