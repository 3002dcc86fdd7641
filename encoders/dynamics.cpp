// SPDX-License-Identifier: Apache-2.0
#include "encoders/dynamics.h"

namespace engram::encoders {

using torch::Tensor;

namespace {

constexpr double kSlope = 0.1;
constexpr int kNumberFeatures = 128;
/// Logit that gates start with: 27 % open.
constexpr double kFirstGate = -1.0;

Tensor activate(const Tensor& x) {
  return torch::leaky_relu(x, kSlope);
}

}  // namespace

ImageDynamicsImpl::ImageDynamicsImpl(const ImageShape& image, const NetworkShape& network,
                                     int number_features)
    : stride(image.stride) {
  const int latents = network.latent_channels;
  const int features = network.width * 3 / 2;
  input = register_module("input", make_conv(2 * latents, features, 3));
  if (number_features > 0)
    from_numbers = register_module("from_numbers", make_zero_linear(number_features, features));
  block_1 = register_module("block_1", ResidualBlock(features));
  block_2 = register_module("block_2", ResidualBlock(features));
  change = register_module("change", make_conv(features, latents, 1, true));
  gate = register_module("gate", make_conv(features, stride * stride, 1, true));
  torch::NoGradGuard no_grad;
  gate->bias.fill_(kFirstGate);
}

std::pair<Tensor, Tensor> ImageDynamicsImpl::forward(const Tensor& now, const Tensor& before,
                                                     const Tensor& features) {
  Tensor x = input(torch::cat({now, now - before}, 1));  // [B, F, h, w]
  if (features.defined() && from_numbers) x = x + from_numbers(features).unsqueeze(2).unsqueeze(3);
  x = activate(block_2(block_1(x)));
  return {change(x), torch::sigmoid(torch::pixel_shuffle(gate(x), stride))};
}

DynamicsImpl::DynamicsImpl(const NetworkShape& network) : shape(network) {
  const int features = network.numbers > 0 ? kNumberFeatures : 0;
  for (size_t i = 0; i < network.images.size(); ++i)
    images.push_back(register_module("image" + std::to_string(i),
                                     ImageDynamics(network.images[i], network, features)));
  if (network.numbers == 0) return;
  number_input =
      register_module("number_input", torch::nn::Linear(2 * network.number_latents, features));
  number_hidden = register_module("number_hidden", torch::nn::Linear(features, features));
  number_change =
      register_module("number_change", make_zero_linear(features, network.number_latents));
  number_gate = register_module("number_gate", make_zero_linear(features, network.numbers));
}

DynamicsStep DynamicsImpl::forward(Autoencoder& autoencoder, const Parts& now,
                                   const Parts& before) {
  DynamicsStep step;
  Tensor features;
  if (number_input) {
    const Tensor& scale = autoencoder->numbers->latent_scale;
    const Tensor x = now.numbers / scale;
    const Tensor speed = (now.numbers - before.numbers) / scale;
    features = activate(number_input(torch::cat({x, speed}, 1)));  // [B, K]
    features = activate(number_hidden(features));
    step.change.numbers = number_change(features) * scale;     // [B, M]
    step.number_gate = torch::sigmoid(number_gate(features));  // [B, N]
  }
  for (size_t i = 0; i < images.size(); ++i) {
    const Tensor& scale = autoencoder->images[i]->latent_scale;
    auto [change, gate] =
        images[i]->forward(now.images[i] / scale, before.images[i] / scale, features);
    step.change.images.push_back(change * scale);
    step.gates.push_back(gate);
  }
  return step;
}

namespace {

Parts sum(const Parts& a, const Parts& b) {
  Parts result;
  for (size_t i = 0; i < a.images.size(); ++i) result.images.push_back(a.images[i] + b.images[i]);
  if (a.numbers.defined()) result.numbers = a.numbers + b.numbers;
  return result;
}

Parts gated(const Parts& last, const DynamicsStep& step, const Parts& then, const Parts& now) {
  Parts values;
  for (size_t i = 0; i < last.images.size(); ++i)
    values.images.push_back(
        (last.images[i] + step.gates[i] * (then.images[i] - now.images[i])).clamp(0, 255));
  if (last.numbers.defined())
    values.numbers = last.numbers + step.number_gate * (then.numbers - now.numbers);
  return values;
}

}  // namespace

std::vector<Parts> roll_out(Autoencoder& autoencoder, Dynamics& dynamics, const Parts& last,
                            const Parts& now, const Parts& before, int steps) {
  const Parts decoded = autoencoder->decode(now);
  std::vector<Parts> values;
  Parts previous = before;
  Parts current = now;
  for (int i = 0; i < steps; ++i) {
    const DynamicsStep step = dynamics->forward(autoencoder, current, previous);
    previous = current;
    current = sum(current, step.change);
    values.push_back(gated(last, step, autoencoder->decode(current), decoded));
  }
  return values;
}

}  // namespace engram::encoders
