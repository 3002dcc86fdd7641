// SPDX-License-Identifier: Apache-2.0
#include "encoders/layers.h"

#include <string>

namespace engram::encoders {

using torch::Tensor;

namespace {

constexpr double kSlope = 0.1;

}  // namespace

Tensor activate(const Tensor& x) {
  return torch::leaky_relu(x, kSlope);
}

Tensor activate(Tensor&& x) {
  return torch::leaky_relu_(x, kSlope);
}

Tensor unshuffled(const Tensor& x, int factor) {
  return torch::pixel_unshuffle(x, factor).contiguous(at::MemoryFormat::ChannelsLast);
}

// One convolution with stride 2 is faster than unshuffling and a 1x1 convolution: LibTorch computes
// 1x1 convolutions image by image if there is one thread.
Tensor halved(torch::nn::Conv2d& conv, const Tensor& x) {
  const Tensor& weight = conv->weight;
  return torch::conv2d(x, weight.reshape({weight.size(0), -1, 2, 2}), conv->bias, 2);
}

// For the same reason this is one matrix product. The copy after it moves runs of channels, while
// LibTorch's pixel shuffle goes pixel by pixel.
Tensor doubled(torch::nn::Conv2d& conv, const Tensor& x) {
  const int64_t features = conv->weight.size(0) / 4;
  const Tensor weight = conv->weight.reshape({features, 4, -1}).transpose(0, 1).flatten(0, 1);
  const Tensor bias = conv->bias.reshape({features, 4}).t().flatten();
  const Tensor rows = x.permute({0, 2, 3, 1});  // [B, H, W, C]
  const Tensor all = torch::linear(rows.flatten(0, 2), weight, bias);
  return all.reshape({x.size(0), x.size(2), x.size(3), 2, 2, features})
      .permute({0, 1, 3, 2, 4, 5})
      .reshape({x.size(0), 2 * x.size(2), 2 * x.size(3), features})
      .permute({0, 3, 1, 2});
}

Tensor with_known(const Tensor& x, const Tensor& known) {
  if (known.size(0) == x.size(0) || known.size(0) == 1) return x + known;
  return (x.unflatten(0, {known.size(0), -1}) + known.unsqueeze(1)).flatten(0, 1);
}

torch::nn::Conv2d make_conv(int in, int out, int kernel, bool starts_at_zero) {
  torch::nn::Conv2d conv(torch::nn::Conv2dOptions(in, out, kernel).padding(kernel / 2));
  torch::NoGradGuard no_grad;
  if (starts_at_zero) {
    conv->weight.zero_();
    conv->bias.zero_();
  }
  conv->weight.set_data(conv->weight.contiguous(at::MemoryFormat::ChannelsLast));
  return conv;
}

torch::nn::Linear make_zero_linear(int in, int out) {
  torch::nn::Linear linear(in, out);
  torch::NoGradGuard no_grad;
  linear->weight.zero_();
  linear->bias.zero_();
  return linear;
}

Tensor with_features(const Tensor& x, const Tensor& features) {
  return x + features.unsqueeze(2).unsqueeze(3);
}

ResidualBlockImpl::ResidualBlockImpl(int features)
    : first(register_module("first", make_conv(features, features, 3))),
      second(register_module("second", make_conv(features, features, 3, true))) {}

Tensor ResidualBlockImpl::forward(const Tensor& x) {
  return second(activate(first(x))).add_(x);
}

ResidualBlocksImpl::ResidualBlocksImpl(int features, int count) {
  for (int i = 0; i < count; ++i)
    blocks.push_back(register_module("block" + std::to_string(i), ResidualBlock(features)));
}

Tensor ResidualBlocksImpl::forward(const Tensor& x) {
  Tensor y = x;
  for (ResidualBlock& block : blocks) y = block(y);
  return y;
}

}  // namespace engram::encoders
