// SPDX-License-Identifier: Apache-2.0
#include "encoders/layers.h"

#include <gtest/gtest.h>

namespace engram::encoders {
namespace {

using torch::Tensor;

constexpr int kIn = 6;

Tensor image_features() {
  return torch::randn({2, kIn, 8, 12}).contiguous(at::MemoryFormat::ChannelsLast);
}

/// What training sees of a way to compute.
struct Computed {
  Tensor value, of_input, of_weight, of_bias;
};

template <typename Compute>
Computed computed(torch::nn::Conv2d& conv, const Tensor& x, const Tensor& wanted, Compute compute) {
  conv->zero_grad();
  const Tensor input = x.clone().set_requires_grad(true);
  const Tensor value = compute(input);
  (value * wanted).sum().backward();
  return {value.detach(), input.grad(), conv->weight.grad().clone(), conv->bias.grad().clone()};
}

void expect_equal(const Computed& quick, const Computed& plain) {
  EXPECT_TRUE(torch::allclose(quick.value, plain.value, 1e-4, 1e-5));
  EXPECT_TRUE(torch::allclose(quick.of_input, plain.of_input, 1e-4, 1e-5));
  EXPECT_TRUE(torch::allclose(quick.of_weight, plain.of_weight, 1e-4, 1e-4));
  EXPECT_TRUE(torch::allclose(quick.of_bias, plain.of_bias, 1e-4, 1e-4));
}

TEST(Layers, HalvedIsAConvolutionOfUnshuffledPixels) {
  auto conv = make_conv(4 * kIn, 5, 1);
  const Tensor x = image_features();
  const Tensor wanted = torch::randn({2, 5, 4, 6});
  expect_equal(
      computed(conv, x, wanted, [&](const Tensor& in) { return halved(conv, in); }),
      computed(conv, x, wanted, [&](const Tensor& in) { return conv(unshuffled(in, 2)); }));
}

TEST(Layers, DoubledIsAConvolutionWhosePixelsAreShuffled) {
  auto conv = make_conv(kIn, 4 * 5, 1);
  const Tensor x = image_features();
  const Tensor wanted = torch::randn({2, 5, 16, 24});
  expect_equal(computed(conv, x, wanted, [&](const Tensor& in) { return doubled(conv, in); }),
               computed(conv, x, wanted,
                        [&](const Tensor& in) { return torch::pixel_shuffle(conv(in), 2); }));
}

TEST(Layers, ResidualBlocksLeaveTheirInputAsItIs) {
  ResidualBlock block(kIn);
  torch::NoGradGuard no_grad;
  block->second->weight.normal_();
  const Tensor x = image_features();
  const Tensor before = x.clone();
  const Tensor after = block(x);
  EXPECT_TRUE(x.equal(before));
  EXPECT_TRUE(torch::allclose(after, x + block->second(activate(block->first(x))), 1e-4, 1e-5));
}

TEST(Layers, WhatIsKnownOfImagesIsAddedToTheRowsOfEach) {
  const Tensor x = torch::randn({6, 2, 3, 4});
  const Tensor known = torch::randn({2, 2, 3, 4});
  const Tensor sum = with_known(x, known);
  for (int64_t row = 0; row < 6; ++row)
    EXPECT_TRUE(sum.select(0, row).equal(x.select(0, row) + known.select(0, row / 3))) << row;
  EXPECT_TRUE(with_known(x, known.slice(0, 0, 1)).equal(x + known.slice(0, 0, 1)));
}

}  // namespace
}  // namespace engram::encoders
