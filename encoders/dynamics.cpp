// SPDX-License-Identifier: Apache-2.0
#include "encoders/dynamics.h"

#include <algorithm>
#include <array>
#include <numbers>

#include "encoders/moved_images.h"

namespace engram::encoders {

using torch::Tensor;

namespace {

constexpr int kNumberFeatures = 128;
constexpr int kMotionFeatures = 16;
constexpr int kConditionFeatures = 64;
/// Factor of the changes of conditions relative to their values.
constexpr double kChangeGain = 3.0;
/// Initial logit of gates: they start 27 % open.
constexpr double kFirstGate = -1.0;
/// Max magnitude of numbers and their changes, in deviations. Without it, linear layers extrapolate
/// without limit beyond the training data.
constexpr double kMaxDeviations = 5.0;
constexpr double kMinLogScale = -4.0;
constexpr double kMaxLogScale = 6.0;
/// Min probability of a latent, which bounds its cost at -log2 of it.
constexpr double kMinProbability = 1e-7;

Tensor twice_as_large(const Tensor& x) {
  namespace F = torch::nn::functional;
  return F::interpolate(x, F::InterpolateFuncOptions()
                               .scale_factor(std::vector<double>{2.0, 2.0})
                               .mode(torch::kNearest));
}

/// Clamps normalised numbers.
Tensor saturated(const Tensor& numbers) {
  return numbers.clamp(-kMaxDeviations, kMaxDeviations);
}

/// Shape: [B].
Tensor bits_of(const Tensor& z, const ExpectedLatents& expected) {
  return laplace_bits((z - expected.mean).abs(), expected.log_scale.exp()).sum({1, 2, 3});
}

}  // namespace

Tensor laplace_bits(const Tensor& distance, const Tensor& scale) {
  const Tensor above = 0.5 * torch::exp(-(distance + 0.5) / scale);
  const Tensor outside = 0.5 * torch::exp(-(distance - 0.5).clamp_min(0) / scale) - above;
  const Tensor inside = 1 - 0.5 * torch::exp(-(0.5 - distance).clamp_min(0) / scale) - above;
  const Tensor probability = torch::where(distance > 0.5, outside, inside);
  return torch::log(probability.clamp_min(kMinProbability)) * (-1.0 / std::numbers::ln2);
}

LatentPriorImpl::LatentPriorImpl(int channels, int known, int features)
    : input(register_module("input", make_conv(2 * channels + known, features, 3))),
      output(register_module("output", make_conv(features, 2 * channels, 1, true))),
      block(register_module("block", ResidualBlock(features))) {}

ExpectedLatents LatentPriorImpl::forward(const Tensor& last, const Tensor& before,
                                         const Tensor& known, const Tensor& added) {
  std::vector<Tensor> inputs{last, last - before};
  if (known.defined()) inputs.push_back(known);
  Tensor x = input(torch::cat(inputs, 1));
  if (added.defined()) x = with_features(x, added);
  x = activate(block(x));
  const std::vector<Tensor> outputs = output(x).chunk(2, 1);
  return {last + outputs[0], outputs[1].clamp(kMinLogScale, kMaxLogScale), x};
}

ImageDynamicsImpl::ImageDynamicsImpl(const ImageShape& shape, const NetworkSizes& sizes,
                                     int number_features, int motion_features)
    : stride(shape.coarse_stride()) {
  const int features = sizes.width / 2;
  coarse_prior = register_module("coarse_prior", LatentPrior(sizes.coarse_channels, 0, features));
  fine_prior = register_module(
      "fine_prior", LatentPrior(sizes.fine_channels, sizes.coarse_channels, features / 2));
  gate_output = register_module("gate_output", make_conv(features, stride * stride, 1, true));
  if (number_features > 0)
    from_numbers = register_module("from_numbers", make_zero_linear(number_features, features));
  motion = register_module("motion", ImageMotion(shape, kMotionFeatures, motion_features));
  torch::NoGradGuard no_grad;
  gate_output->bias.fill_(kFirstGate);
}

ExpectedLatents ImageDynamicsImpl::coarse(const ImageLatents& last, const ImageLatents& before,
                                          const Tensor& number_features) {
  return coarse_prior(last.coarse, before.coarse, Tensor(),
                      from_numbers ? from_numbers(number_features) : Tensor());
}

ExpectedLatents ImageDynamicsImpl::fine(const ImageLatents& last, const ImageLatents& before,
                                        const Tensor& then) {
  return fine_prior(last.fine, before.fine, twice_as_large(then), Tensor());
}

Tensor ImageDynamicsImpl::gate(const Tensor& features) {
  return torch::sigmoid(torch::pixel_shuffle(gate_output(features), stride));
}

DynamicsImpl::DynamicsImpl(const NetworkShape& network) : shape(network) {
  // The order of what is registered here is that of the tensors in a model file (layers.h).
  const int features = network.numbers > 0 ? kNumberFeatures : 0;
  const bool has_images = !network.images.empty() && network.sizes.width > 0;
  const int conditions = has_images ? network.sizes.conditions : 0;
  const int told = features + (conditions > 0 ? kConditionFeatures : 0);
  for (size_t i = 0; i < network.images.size() && has_images; ++i)
    images.push_back(
        register_module("image" + std::to_string(i),
                        ImageDynamics(network.images[i], network.sizes, features, told)));
  if (conditions > 0) {
    // The input is values and changes, the plan, and two flags: whether each of the two is known.
    const int inputs = (2 + ImageMotionImpl::kSteps) * conditions + 2;
    condition_input =
        register_module("condition_input", torch::nn::Linear(inputs, kConditionFeatures));
    condition_hidden = register_module("condition_hidden",
                                       torch::nn::Linear(kConditionFeatures, kConditionFeatures));
  }
  if (network.numbers == 0) return;
  number_input = register_module("number_input", torch::nn::Linear(2 * network.numbers, features));
  number_hidden = register_module("number_hidden", torch::nn::Linear(features, features));
  number_change = register_module("number_change", make_zero_linear(features, network.numbers));
  number_gate = register_module("number_gate", make_zero_linear(features, network.numbers));
}

Tensor DynamicsImpl::number_features(const Tensor& last, const Tensor& before) {
  if (!number_input) return {};
  const Tensor x = torch::cat({saturated(last), saturated(last - before)}, 1);
  return activate(number_hidden(activate(number_input(x))));
}

Tensor DynamicsImpl::condition_features(const Parts& last, const Parts& before, int ahead) {
  const int64_t count = last.scene.size(0);
  if (!last.conditions.defined() || !before.conditions.defined()) {
    const Tensor nothing = torch::zeros({count, condition_input->options.in_features()});
    return activate(condition_hidden(activate(condition_input(nothing))));
  }
  const bool is_planned = last.plan.defined() && last.plan.size(1) > 0;
  // Steps of the plan count from the last known moment.
  const auto at = [&](int moment) {
    if (moment < 0) return before.conditions;
    if (moment == 0) return last.conditions;
    return last.plan.select(1, std::min<int64_t>(moment, last.plan.size(1)) - 1);
  };
  const auto change = [&](int from, int to) { return saturated(at(to) - at(from)) * kChangeGain; };
  const int now = is_planned ? ahead : 0;
  std::vector<Tensor> told{saturated(at(now)), change(now - 1, now), torch::ones({count, 1})};
  for (int step = 1; step <= ImageMotionImpl::kSteps; ++step)
    told.push_back(is_planned ? change(now, now + step) : torch::zeros_like(last.conditions));
  told.push_back(torch::full({count, 1}, is_planned ? 1.0 : 0.0));
  return activate(condition_hidden(activate(condition_input(torch::cat(told, 1)))));
}

Tensor DynamicsImpl::motion_features(const Parts& last, const Parts& before, int ahead) {
  std::vector<Tensor> features;
  if (number_input) features.push_back(number_features(last.numbers, before.numbers));
  if (condition_input) features.push_back(condition_features(last, before, ahead));
  return features.empty() ? Tensor() : torch::cat(features, 1);
}

Tensor DynamicsImpl::bits(const Latents& then, const Latents& last, const Latents& before) {
  const Tensor features = number_features(last.numbers, before.numbers);
  Tensor sum = torch::zeros({then.scene.size(0)});
  for (size_t i = 0; i < images.size(); ++i) {
    const ImageLatents& z = then.images[i];
    sum = sum + bits_of(z.coarse, images[i]->coarse(last.images[i], before.images[i], features)) +
          bits_of(z.fine, images[i]->fine(last.images[i], before.images[i], z.coarse));
  }
  return sum;
}

DynamicsStep DynamicsImpl::step(const Latents& last, const Latents& before) {
  DynamicsStep step{{{}, last.numbers, last.scene, last.backgrounds}, {}, {}};
  const Tensor features = number_features(last.numbers, before.numbers);
  if (features.defined()) {
    step.then.numbers = last.numbers + number_change(features);
    step.number_gate = torch::sigmoid(number_gate(features));
  }
  for (size_t i = 0; i < images.size(); ++i) {
    const ExpectedLatents coarse = images[i]->coarse(last.images[i], before.images[i], features);
    const ExpectedLatents fine = images[i]->fine(last.images[i], before.images[i], coarse.mean);
    step.then.images.push_back({coarse.mean, fine.mean});
    step.gates.push_back(images[i]->gate(coarse.features));
  }
  return step;
}

std::vector<std::vector<Tensor>> DynamicsImpl::move(const Parts& last, const Parts& before,
                                                    int steps) {
  std::vector<std::vector<Tensor>> moved(static_cast<size_t>(steps));
  for (size_t i = 0; i < images.size(); ++i) {
    std::array<Tensor, 2> seen{before.images[i], last.images[i]};
    for (size_t step = 0; step < moved.size();) {
      // Later steps continue from predicted images.
      const Tensor features = motion_features(last, before, static_cast<int>(step));
      const Tensor moved_images = moved_on(seen[0], seen[1], ImageMotionImpl::kSteps);
      for (Tensor& image : images[i]->motion(seen[1], seen[0], moved_images, features)) {
        seen = {seen[1], image.clamp(0, 255)};
        if (step < moved.size()) moved[step++].push_back(seen[1]);
      }
    }
  }
  return moved;
}

namespace {

Parts gated(const Parts& last, const DynamicsStep& step, const Parts& then, const Parts& now) {
  Parts values{{}, {}, last.scene};
  if (then.images.empty()) values.images = last.images;  // The model has no networks.
  for (size_t i = 0; i < then.images.size(); ++i)
    values.images.push_back(
        (last.images[i] + step.gates[i] * (then.images[i] - now.images[i])).clamp(0, 255));
  if (last.numbers.defined())
    values.numbers = last.numbers + step.number_gate * (then.numbers - now.numbers);
  return values;
}

}  // namespace

std::vector<Parts> roll_out(Autoencoder& autoencoder, Dynamics& dynamics, const Parts& last,
                            const Latents& now, const Latents& before, std::span<const int> steps) {
  const Views views = autoencoder->views_of(now.scene, now.backgrounds);
  const Parts decoded = autoencoder->decode(now, views);
  std::vector<Parts> values;
  Latents previous = before;
  Latents current = now;
  int passed = 0;
  for (const int wanted : steps) {
    DynamicsStep step;
    for (; passed < wanted; ++passed) {
      step = dynamics->step(current, previous);
      previous = current;
      current = step.then;
    }
    values.push_back(gated(last, step, autoencoder->decode(current, views), decoded));
  }
  return values;
}

}  // namespace engram::encoders
