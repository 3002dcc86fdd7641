// SPDX-License-Identifier: Apache-2.0
#include "encoders/motion.h"

#include <gtest/gtest.h>

namespace engram::encoders {
namespace {

using torch::Tensor;

/// A flow that is the same everywhere.
Tensor flow_of(const Tensor& image, double right, double down) {
  const Tensor one = torch::zeros({image.size(0), 1, image.size(2), image.size(3)});
  return torch::cat({one + right, one + down}, 1);
}

TEST(Warp, ReadsPlacesThatLieOff) {
  const Tensor image = torch::rand({2, 3, 12, 20}) * 255;
  const Tensor moved = warp(image, flow_of(image, 3, -2));
  const Tensor expected = image.slice(2, 0, 10).slice(3, 3, 20);
  EXPECT_TRUE(torch::allclose(moved.slice(2, 2, 12).slice(3, 0, 17), expected, 1e-4, 1e-2));
}

TEST(Warp, RepeatsTheEdge) {
  const Tensor image = torch::rand({1, 1, 8, 8});
  const Tensor moved = warp(image, flow_of(image, 4, 0));
  for (int64_t x = 4; x < 8; ++x)
    EXPECT_TRUE(torch::allclose(moved.select(3, x), image.select(3, 7), 1e-4, 1e-5)) << x;
}

TEST(Warp, ReadsBetweenPixels) {
  const Tensor image =
      torch::arange(16, torch::kFloat32).reshape({1, 1, 1, 16}).repeat({1, 1, 4, 1});
  const Tensor moved = warp(image, flow_of(image, 0.25, 0));
  EXPECT_NEAR(moved[0][0][1][7].item<double>(), 7.25, 1e-4);
}

TEST(ImageMotion, StartsBetweenACopyAndWhatFlowMakesOfIt) {
  for (const int unit : {1, 2}) {
    const ImageShape shape{3, 32 * unit, 48 * unit, unit};
    ImageMotion motion(shape, 8, 0);
    const Tensor last = torch::rand({2, 3, shape.height, shape.width}) * 255;
    const Tensor moved = torch::rand({2, 2, 3, shape.height, shape.width}) * 255;
    const auto images = motion(last, torch::rand_like(last) * 255, moved, Tensor());
    ASSERT_EQ(images.size(), static_cast<size_t>(ImageMotionImpl::kSteps));
    for (int64_t k = 0; k < 2; ++k) {
      const Tensor share = (images[static_cast<size_t>(k)] - last) / (moved.select(1, k) - last);
      EXPECT_NEAR(share.median().item<double>(), 0.27, 0.01) << k;
    }
  }
}

TEST(ImageMotion, LearnsToMoveOn) {
  torch::manual_seed(1);
  ImageMotion motion(ImageShape{1, 32, 32, 1}, 8, 0);
  torch::optim::Adam optimiser(motion->parameters(), torch::optim::AdamOptions(3e-3));
  // A pattern that moves by two pixels a step.
  const auto pattern_at = [](const Tensor& wide, int64_t step) {
    return wide.slice(3, 2 * step, 2 * step + 32);
  };
  double first = 0;
  double last = 0;
  for (int step = 0; step < 60; ++step) {
    const Tensor wide =
        torch::nn::functional::interpolate(torch::rand({4, 1, 8, 12}),
                                           torch::nn::functional::InterpolateFuncOptions()
                                               .size(std::vector<int64_t>{32, 48})
                                               .mode(torch::kBilinear)
                                               .align_corners(false)) *
        255;
    // Flow that found nothing: copies.
    const Tensor moved = torch::stack({pattern_at(wide, 1), pattern_at(wide, 1)}, 1);
    const auto images = motion(pattern_at(wide, 1), pattern_at(wide, 0), moved, Tensor());
    const Tensor error = (images[0] - pattern_at(wide, 2)).square().mean() +
                         (images[1] - pattern_at(wide, 3)).square().mean();
    optimiser.zero_grad();
    error.backward();
    optimiser.step();
    last = error.item<double>();
    if (step == 0) first = last;
  }
  EXPECT_LT(last, first / 2);
}

}  // namespace
}  // namespace engram::encoders
