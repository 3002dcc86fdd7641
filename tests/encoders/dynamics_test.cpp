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

constexpr int kConditions = 3;

/// Dynamics of one small image beside conditions, whose features depend on all that is told.
Dynamics told_dynamics() {
  torch::manual_seed(5);
  NetworkShape shape;
  shape.sizes.width = 32;
  shape.sizes.conditions = kConditions;
  shape.images.push_back({1, 32, 32, 1});
  Dynamics dynamics(shape);
  torch::NoGradGuard no_grad;
  dynamics->images[0]->motion->from_added->weight.normal_(0, 0.1);
  dynamics->images[0]->motion->out->weight.normal_(0, 0.1);
  return dynamics;
}

/// A moment with conditions of this size.
Parts moment(double conditions) {
  Parts parts;
  parts.images.push_back(torch::full({1, 1, 32, 32}, 90.0));
  parts.scene = torch::zeros({1}, torch::kLong);
  parts.conditions = torch::full({1, kConditions}, conditions);
  return parts;
}

/// Planned moments with conditions of these sizes.
Tensor plan_of(const std::vector<double>& conditions) {
  std::vector<Tensor> steps;
  for (const double one : conditions) steps.push_back(torch::full({1, kConditions}, one));
  return torch::stack(steps, 1);
}

TEST(MotionFeatures, FollowAPlanThatStandsStillBeyondItsEnd) {
  torch::NoGradGuard no_grad;
  Dynamics dynamics = told_dynamics();
  const Parts before = moment(0.1);
  const Parts unplanned = moment(0.4);
  const auto features = [&](const std::vector<double>& plan, int ahead) {
    Parts last = moment(0.4);
    if (!plan.empty()) last.plan = plan_of(plan);
    return dynamics->motion_features(last, before, ahead);
  };
  EXPECT_FALSE(features({0.9, 1.2}, 0).allclose(features({}, 0)));
  EXPECT_FALSE(features({0.9, 1.2}, 0).allclose(features({0.9, 0.2}, 0)));
  EXPECT_TRUE(features({0.9}, 0).equal(features({0.9, 0.9, 0.9}, 0)));
  EXPECT_TRUE(features({0.9, 1.2, 7.0}, 0).equal(features({0.9, 1.2}, 0))) << "looks two ahead";
  EXPECT_FALSE(features({0.9, 1.2, 7.0}, 2).allclose(features({0.9, 1.2}, 2)));
  // Two steps on, what was planned for then is where things are.
  Parts later = moment(1.2);
  later.plan = plan_of({1.5, 1.6});
  EXPECT_TRUE(
      dynamics->motion_features(later, moment(0.9), 0).allclose(features({0.9, 1.2, 1.5, 1.6}, 2)));
  // Without a plan later steps are told what is known now.
  EXPECT_TRUE(features({}, 2).equal(features({}, 0)));
  // What is not known cannot be planned.
  Parts unknown = unplanned;
  unknown.conditions = Tensor();
  Parts planned = unknown;
  planned.plan = plan_of({0.9});
  EXPECT_TRUE(
      dynamics->motion_features(unknown, before).equal(dynamics->motion_features(planned, before)));
}

TEST(MotionFeatures, MoveImagesByThePlan) {
  torch::NoGradGuard no_grad;
  Dynamics dynamics = told_dynamics();
  const auto moved = [&](const std::vector<double>& plan) {
    Parts last = moment(0.4);
    last.plan = plan_of(plan);
    return dynamics->move(last, moment(0.1), 4);
  };
  const auto one = moved({0.9, 1.2, 1.5, 1.6});
  const auto other = moved({0.9, 1.2, 3.5, 9.6});
  ASSERT_EQ(one.size(), 4u);
  EXPECT_TRUE(one[1][0].equal(other[1][0])) << "the first two steps are planned alike";
  EXPECT_FALSE(one[3][0].allclose(other[3][0]));
}

}  // namespace
}  // namespace engram::encoders
