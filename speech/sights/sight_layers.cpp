// SPDX-License-Identifier: Apache-2.0
#include "speech/sights/sight_layers.h"

namespace engram::speech {

namespace {

/// What is left out, and added, in training.
constexpr double kDroppedMaps = 0.1;
constexpr double kDroppedTints = 0.3;
constexpr double kDroppedChannels = 0.05;
constexpr double kNoise = 0.15;
/// Normalised cells are cut off there.
constexpr double kMaxDeviations = 6;
constexpr double kMinDeviation = 0.05;

torch::nn::Conv2d convolution(int64_t from, int64_t to, int64_t side, int64_t dilation = 1) {
  return torch::nn::Conv2d(
      torch::nn::Conv2dOptions(from, to, side).padding(side / 2 * dilation).dilation(dilation));
}

}  // namespace

SightLayersImpl::SightLayersImpl(const SightShape& shape) : shape_(shape) {
  mean = register_buffer("mean", torch::zeros({1, shape.channels, 1, 1}));
  deviation = register_buffer("deviation", torch::ones({1, shape.channels, 1, 1}));
  constexpr int64_t kWidth = SightShape::kWidth;
  near = register_module("near", convolution(shape.channels, kWidth, 3));
  around = register_module("around", convolution(kWidth, kWidth, 3));
  wide = register_module("wide", convolution(kWidth, kWidth, 3, 2));
  whole = register_module("whole", torch::nn::Linear(kWidth, kWidth));
  told = register_module("told", convolution(kWidth, shape.kinds + 1 + shape.places, 1));
  tint = register_module("tint", convolution(shape.channels, SightShape::kColourWidth, 3));
  tint_told = register_module("tint_told", convolution(SightShape::kColourWidth, shape.colours, 1));
}

void SightLayersImpl::fit_normaliser(const torch::Tensor& cells) {
  torch::NoGradGuard no_gradient;
  mean.copy_(cells.mean({0, 2, 3}, true));
  deviation.copy_(cells.std({0, 2, 3}, true, true) + kMinDeviation);
}

SightLogits SightLayersImpl::forward(const torch::Tensor& cells) {
  torch::Tensor x = ((cells - mean) / deviation).clamp(-kMaxDeviations, kMaxDeviations);
  if (is_training()) {
    x = x + kNoise * torch::randn_like(x);
    x = x * torch::rand({x.size(0), x.size(1), 1, 1}).gt(kDroppedChannels).to(torch::kFloat);
  }
  const auto thinned = [this](const torch::Tensor& maps) {
    return torch::nn::functional::dropout2d(
        maps,
        torch::nn::functional::Dropout2dFuncOptions().p(kDroppedMaps).training(is_training()));
  };
  const torch::Tensor tints = torch::nn::functional::dropout(
      torch::relu(tint(x)),
      torch::nn::functional::DropoutFuncOptions().p(kDroppedTints).training(is_training()));
  x = thinned(torch::relu(near(x)));                                            // [B, kWidth, R, C]
  x = thinned(x + torch::relu(around(x)));                                      // [B, kWidth, R, C]
  const torch::Tensor image = whole(x.mean({2, 3})).unsqueeze(2).unsqueeze(3);  // [B, kWidth, 1, 1]
  x = thinned(x + torch::relu(wide(x) + image));                                // [B, kWidth, R, C]
  const torch::Tensor all = told(x);
  return {all.slice(1, 0, shape_.kinds + 1), all.slice(1, shape_.kinds + 1), tint_told(tints)};
}

}  // namespace engram::speech
