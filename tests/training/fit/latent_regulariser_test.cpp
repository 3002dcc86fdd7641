// SPDX-License-Identifier: Apache-2.0
#include "training/fit/latent_regulariser.h"

#include <gtest/gtest.h>

#include <cmath>

#include "training/fit/divergence.h"

namespace engram::training {
namespace {

using encoders::TrainingVariant;
using torch::Tensor;

/// Sum over q(x) log(q(x) / p(x)) on a fine grid, p the unit Gaussian.
double divergence_by_sum(double mean, double deviation) {
  constexpr double kStep = 1e-3;
  double sum = 0;
  for (double x = mean - 12 * deviation; x < mean + 12 * deviation; x += kStep) {
    const double z = (x - mean) / deviation;
    const double log_q = -0.5 * z * z - std::log(deviation);
    sum += kStep * std::exp(log_q) / std::sqrt(2 * M_PI) * (log_q + 0.5 * x * x);
  }
  return sum;
}

TEST(Divergence, OfAGaussianIsTheSumOverItsDensity) {
  for (const double mean : {0.0, -0.7, 2.5})
    for (const double deviation : {0.1, 1.0, 1.8}) {
      const Tensor found =
          gaussian_divergence(torch::tensor({mean}), torch::tensor({2 * std::log(deviation)}));
      EXPECT_NEAR(found.item<double>(), divergence_by_sum(mean, deviation), 1e-4)
          << mean << " " << deviation;
    }
}

/// The discrepancy as it is defined, pair by pair.
double discrepancy_by_pairs(const Tensor& x, const Tensor& y) {
  const auto mean_kernel = [](const Tensor& a, const Tensor& b) {
    double sum = 0;
    for (int64_t i = 0; i < a.size(0); ++i)
      for (int64_t j = 0; j < b.size(0); ++j) {
        const double distance = (a[i] - b[j]).square().sum().item<double>();
        for (const double scale : {0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0}) {
          const double c = 2.0 * static_cast<double>(a.size(1)) * scale;
          sum += c / (c + distance) / 7.0;
        }
      }
    return sum / static_cast<double>(a.size(0) * b.size(0));
  };
  return mean_kernel(x, x) + mean_kernel(y, y) - 2 * mean_kernel(x, y);
}

TEST(Discrepancy, IsThatOfAllPairs) {
  torch::manual_seed(3);
  const Tensor x = torch::randn({9, 5});
  const Tensor y = 2.0 * torch::randn({13, 5}) + 1.0;
  EXPECT_NEAR(mean_discrepancy(x, y).item<double>(), discrepancy_by_pairs(x, y), 1e-5);
}

TEST(Discrepancy, TellsSamplesOfOneDistributionFromThoseOfTwo) {
  torch::manual_seed(4);
  const Tensor x = torch::randn({400, 8});
  EXPECT_NEAR(mean_discrepancy(x, x).item<double>(), 0.0, 1e-5);
  const double alike = mean_discrepancy(x, torch::randn({400, 8})).item<double>();
  const double shifted = mean_discrepancy(x, torch::randn({400, 8}) + 0.5).item<double>();
  const double wider = mean_discrepancy(x, 2.0 * torch::randn({400, 8})).item<double>();
  EXPECT_LT(alike, 0.01);
  EXPECT_GT(shifted, 5 * alike);
  EXPECT_GT(wider, 5 * alike);
}

/// Two images of 64 x 48 and few channels.
encoders::NetworkShape small_shape() {
  encoders::NetworkShape shape;
  shape.sizes.width = 16;
  shape.sizes.coarse_channels = 6;
  shape.images.assign(2, {3, 48, 64, 1});
  return shape;
}

/// Latents that need gradients, about three steps wide.
encoders::Latents some_latents(const encoders::NetworkShape& shape, int64_t batch) {
  encoders::Latents latents{{}, {}, torch::zeros({batch}, torch::kLong)};
  for (size_t i = 0; i < shape.images.size(); ++i) {
    const auto grids = shape.grids(i);
    const auto grid = [&](const auto& g) {
      return (3.0 * torch::randn({batch, g.channels, g.height, g.width})).requires_grad_();
    };
    latents.images.push_back({grid(grids[0]), grid(grids[1])});
  }
  return latents;
}

class EveryVariant : public ::testing::TestWithParam<TrainingVariant> {};

TEST_P(EveryVariant, GivesTheDecoderLatentsNearTheExactOnesAndThePriorNumbersToStore) {
  torch::manual_seed(5);
  const auto shape = small_shape();
  const auto regulariser = make_latent_regulariser(GetParam(), shape);
  const auto exact = some_latents(shape, 10);
  for (const bool is_noisy : {true, false}) {
    const auto found = regulariser->regularise(exact, is_noisy);
    ASSERT_EQ(found.decoded.images.size(), 2u);
    for (size_t i = 0; i < 2; ++i) {
      const Tensor& z = exact.images[i].coarse;
      const Tensor error = found.decoded.images[i].coarse - z;
      EXPECT_LT(error.square().mean().item<double>(), 1.5);
      EXPECT_NEAR(error.mean().item<double>(), 0.0, 0.1);
      EXPECT_TRUE(found.decoded.images[i].fine.requires_grad());
      if (GetParam() == TrainingVariant::kRateAware && is_noisy) continue;
      EXPECT_TRUE(torch::equal(found.coded.images[i].fine.round(), exact.images[i].fine.round()));
      EXPECT_NEAR((found.coded.images[i].coarse - z.round()).abs().max().item<double>(), 0, 1e-5);
    }
    EXPECT_GE(found.cost.min().item<double>(), 0.0);
    EXPECT_EQ(found.coded.images[0].coarse.requires_grad(),
              GetParam() == TrainingVariant::kRateAware);
  }
}

TEST_P(EveryVariant, DrawsLatentsTowardsItsPriorWhereItHasOne) {
  torch::manual_seed(6);
  const auto shape = small_shape();
  const auto regulariser = make_latent_regulariser(GetParam(), shape);
  auto latents = some_latents(shape, 64);
  std::vector<Tensor> parameters = regulariser->parameters();
  {
    torch::NoGradGuard no_grad;  // Far off: a mean of 40 steps.
    for (auto& image : latents.images) image.coarse.add_(40.0);
  }
  for (auto& image : latents.images) parameters.push_back(image.coarse);
  torch::optim::Adam optimiser(parameters, torch::optim::AdamOptions(0.5));
  double first = 0, last = 0;
  for (int step = 0; step < 80; ++step) {
    optimiser.zero_grad();
    const Tensor cost = regulariser->regularise(latents, true).cost.mean();
    if (step == 0) first = cost.item<double>();
    last = cost.item<double>();
    if (cost.requires_grad()) cost.backward();
    optimiser.step();
  }
  const double mean = latents.images[0].coarse.mean().item<double>();
  const bool has_prior = GetParam() == TrainingVariant::kVae || GetParam() == TrainingVariant::kWae;
  if (has_prior) {
    EXPECT_LT(last, 0.5 * first);
    // Of a code that is a few directions of the latents, only those move.
    if (GetParam() == TrainingVariant::kVae) {
      EXPECT_LT(std::abs(mean), 20.0);
    }
  } else {
    EXPECT_EQ(first, 0.0);
    EXPECT_NEAR(mean, 40.0, 0.5);
  }
}

INSTANTIATE_TEST_SUITE_P(Regularisers, EveryVariant,
                         ::testing::ValuesIn(encoders::kTrainingVariants),
                         [](const auto& tested) { return std::string(to_string(tested.param)); });

TEST(TrainingVariants, AreNamedAndFound) {
  for (const TrainingVariant variant : encoders::kTrainingVariants)
    EXPECT_EQ(*encoders::training_variant_of(to_string(variant)), variant);
  EXPECT_EQ(encoders::training_variant_of("gan").status().code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace engram::training
