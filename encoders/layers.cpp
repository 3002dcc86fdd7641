// SPDX-License-Identifier: Apache-2.0
#include "encoders/layers.h"

namespace engram::encoders {

using torch::Tensor;

Tensor activate(const Tensor& x) {
  constexpr double kSlope = 0.1;
  return torch::leaky_relu(x, kSlope);
}

Tensor unshuffled(const Tensor& x, int factor) {
  return torch::pixel_unshuffle(x, factor).contiguous(at::MemoryFormat::ChannelsLast);
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
  return x + second(activate(first(x)));
}

}  // namespace engram::encoders
