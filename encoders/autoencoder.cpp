// SPDX-License-Identifier: Apache-2.0
#include "encoders/autoencoder.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace engram::encoders {

namespace F = torch::nn::functional;
using torch::Tensor;

namespace {

constexpr double kSlope = 0.1;
constexpr int kNumberFeatures = 128;
constexpr int64_t kMostPatches = 40000;

Tensor activate(const Tensor& x) {
  return torch::leaky_relu(x, kSlope);
}

Tensor shuffled(const Tensor& x, int factor) {
  return torch::pixel_shuffle(x, factor);
}

Tensor unshuffled(const Tensor& x, int factor) {
  return torch::pixel_unshuffle(x, factor).contiguous(at::MemoryFormat::ChannelsLast);
}

/// Bits of integers `z` under a Laplace distribution of mean 0 and `spread`.
Tensor laplace_bits(const Tensor& z, const Tensor& spread) {
  const Tensor size = z.abs();
  const Tensor rate = 1.0 / spread;
  // log P(|z| >= 1/2) and log P(|z| < 1/2): the integral over [z - 1/2, z + 1/2].
  const Tensor tail =
      -(size - 0.5).clamp_min(0) * rate + torch::log(-torch::expm1(-rate)) - std::numbers::ln2;
  const Tensor inner = torch::log(1.0 - 0.5 * (torch::exp((size.clamp_max(0.5) - 0.5) * rate) +
                                               torch::exp((-size - 0.5) * rate)));
  return torch::where(size >= 0.5, tail, inner) * (-1.0 / std::numbers::ln2);
}

/// The transform that decorrelates the rows of x [n, D]: [count, D], largest variance first.
Tensor principal_axes(const Tensor& x, int64_t count) {
  const Tensor covariance = torch::mm(x.t(), x) / static_cast<double>(x.size(0));
  const Tensor vectors = std::get<1>(torch::linalg_eigh(covariance.to(torch::kFloat64), "L"));
  return vectors.flip({1}).slice(1, 0, count).t().contiguous().to(torch::kFloat32);
}

/// Step of a uniform quantiser with this squared error.
double step_for(double mse) {
  return std::sqrt(12.0 * mse);
}

/// x [B, C, h, w] moved by (dy, dx), zeros where nothing moved in.
Tensor moved(const Tensor& x, int dy, int dx) {
  return torch::constant_pad_nd(x, {dx, -dx, dy, -dy}, 0);
}

}  // namespace

torch::nn::Conv2d make_conv(int in, int out, int kernel, bool starts_at_zero) {
  auto options = torch::nn::Conv2dOptions(in, out, kernel).padding(kernel / 2);
  torch::nn::Conv2d conv(options);
  torch::NoGradGuard no_grad;
  if (starts_at_zero)
    conv->weight.zero_();
  else
    torch::nn::init::kaiming_normal_(conv->weight, kSlope);
  conv->bias.zero_();
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

Parts round(const Parts& latents) {
  Parts rounded;
  for (const Tensor& image : latents.images) rounded.images.push_back(image.round());
  if (latents.numbers.defined()) rounded.numbers = latents.numbers.round();
  return rounded;
}

std::vector<LatentGrid> NetworkShape::grids() const {
  std::vector<LatentGrid> grids;
  for (const ImageShape& image : images)
    grids.push_back({latent_channels, image.height / image.stride, image.width / image.stride});
  if (numbers > 0) grids.push_back({number_latents, 1, 1});
  return grids;
}

ResidualBlockImpl::ResidualBlockImpl(int features)
    : first(register_module("first", make_conv(features, features, 3))),
      second(register_module("second", make_conv(features, features, 3, true))) {}

Tensor ResidualBlockImpl::forward(const Tensor& x) {
  return x + second(activate(first(activate(x))));
}

ImageAutoencoderImpl::ImageAutoencoderImpl(const ImageShape& image, const NetworkShape& network)
    : shape(image) {
  const int patch = image.channels * image.stride * image.stride;
  const int fine = patch / 4;  // channels after unshuffling to twice the resolution of the latents
  const int features = network.width;
  const int coarse = network.width * 3 / 2;
  const int latents = network.latent_channels;
  background = register_parameter("background",
                                  torch::zeros({1, image.channels, image.height, image.width}));
  latent_scale = register_buffer("latent_scale", torch::ones({1, latents, 1, 1}));
  prior = register_parameter("prior", torch::zeros({3, latents, 1, 1}));
  analysis = register_module("analysis", make_conv(patch, latents, 1));
  synthesis = register_module("synthesis", make_conv(latents, patch, 1));
  stem = register_module("stem", make_conv(fine, features, 3));
  down = register_module("down", make_conv(4 * features, coarse, 1));
  encoder_block = register_module("encoder_block", ResidualBlock(coarse));
  code = register_module("code", make_conv(coarse, latents, 1, true));
  from_code = register_module("from_code", make_conv(latents, coarse, 3));
  if (network.number_latents > 0)
    from_numbers =
        register_module("from_numbers", make_zero_linear(network.number_latents, coarse));
  decoder_block_1 = register_module("decoder_block_1", ResidualBlock(coarse));
  decoder_block_2 = register_module("decoder_block_2", ResidualBlock(coarse));
  up = register_module("up", make_conv(coarse, 4 * features, 1));
  fine_block = register_module("fine_block", ResidualBlock(features));
  out = register_module("out", make_conv(features, fine, 3, true));
}

Tensor ImageAutoencoderImpl::encode(const Tensor& x) {
  const Tensor u = x / kGreyLevels - background;                        // [B, C, H, W]
  const Tensor linear = analysis(unshuffled(u, shape.stride));          // [B, Z, h, w]
  const Tensor fine = activate(stem(unshuffled(u, shape.stride / 2)));  // [B, F, 2h, 2w]
  const Tensor coarse = encoder_block(down(unshuffled(fine, 2)));       // [B, 3F/2, h, w]
  return linear + code(activate(coarse)) * latent_scale;
}

Tensor ImageAutoencoderImpl::decode(const Tensor& z, const Tensor& numbers) {
  const Tensor linear = shuffled(synthesis(z), shape.stride);  // [B, C, H, W]
  Tensor coarse = from_code(z / latent_scale);                 // [B, 3F/2, h, w]
  if (numbers.defined() && from_numbers)
    coarse = coarse + from_numbers(numbers).unsqueeze(2).unsqueeze(3);
  coarse = decoder_block_2(decoder_block_1(coarse));
  const Tensor fine = fine_block(shuffled(up(activate(coarse)), 2));     // [B, F, 2h, 2w]
  const Tensor added = shuffled(out(activate(fine)), shape.stride / 2);  // [B, C, H, W]
  return (linear + added + background) * kGreyLevels;
}

Tensor ImageAutoencoderImpl::bits(const Tensor& z) {
  const Tensor size = z.abs();
  const Tensor around =
      (2.0 * (moved(size, 0, 1) + moved(size, 1, 0)) + moved(size, 1, 1) + moved(size, 1, -1)) /
      6.0;  // [B, Z, h, w]
  const int64_t channels = z.size(1);
  const Tensor padded = torch::constant_pad_nd(size, {0, 0, 0, 0, 4, 0}, 0);
  Tensor below = padded.slice(1, 0, channels);
  for (int i = 1; i < 4; ++i) below = below + padded.slice(1, i, i + channels);
  const Tensor log_spread =
      prior[0] + prior[1] * torch::log1p(around) + prior[2] * torch::log1p(below);
  const Tensor spread = torch::exp(log_spread.clamp(-2.5, 8.0));
  return laplace_bits(z, spread).sum({1, 2, 3});  // [B]
}

void ImageAutoencoderImpl::initialise(const Tensor& x, double mse) {
  torch::NoGradGuard no_grad;
  background.copy_(std::get<0>(x.median(0, true)) / kGreyLevels);
  const Tensor u = x / kGreyLevels - background;
  Tensor patches = torch::pixel_unshuffle(u, shape.stride).permute({0, 2, 3, 1});
  patches = patches.reshape({-1, patches.size(3)});  // [n, D]
  if (patches.size(0) > kMostPatches)
    patches =
        patches.index_select(0, torch::randint(patches.size(0), {kMostPatches}, torch::kLong));
  const Tensor axes = principal_axes(patches, analysis->weight.size(0));  // [Z, D]
  const double step = step_for(mse) / kGreyLevels;
  analysis->weight.slice(0, 0, axes.size(0)).copy_((axes / step).unsqueeze(2).unsqueeze(3));
  synthesis->weight.slice(1, 0, axes.size(0)).copy_((axes.t() * step).unsqueeze(2).unsqueeze(3));
  const Tensor z = torch::mm(patches, axes.t()) / step;  // [n, Z]
  latent_scale.slice(1, 0, axes.size(0))
      .copy_((z.square().mean(0).sqrt() + 0.5).reshape({1, -1, 1, 1}));
  prior[0].slice(0, 0, axes.size(0)).copy_((z.abs().mean(0) * 0.3 + 0.1).log().reshape({-1, 1, 1}));
  prior.slice(0, 1, 3).fill_(0.4);
}

std::vector<Tensor> ImageAutoencoderImpl::linear_parameters() const {
  return {analysis->weight, analysis->bias, synthesis->weight, synthesis->bias, background};
}

NumberAutoencoderImpl::NumberAutoencoderImpl(int count, int latents) {
  latent_scale = register_buffer("latent_scale", torch::ones({1, latents}));
  log_spread = register_parameter("log_spread", torch::zeros({1, latents}));
  analysis = register_module("analysis", torch::nn::Linear(count, latents));
  synthesis = register_module("synthesis", torch::nn::Linear(latents, count));
  const int features = std::min(kNumberFeatures, 2 * count + 8);
  encode_1 = register_module("encode_1", torch::nn::Linear(count, features));
  encode_2 = register_module("encode_2", make_zero_linear(features, latents));
  decode_1 = register_module("decode_1", torch::nn::Linear(latents, features));
  decode_2 = register_module("decode_2", make_zero_linear(features, count));
}

Tensor NumberAutoencoderImpl::encode(const Tensor& x) {
  return analysis(x) + encode_2(activate(encode_1(x))) * latent_scale;  // [B, M]
}

Tensor NumberAutoencoderImpl::decode(const Tensor& z) {
  return synthesis(z) + decode_2(activate(decode_1(z / latent_scale)));  // [B, N]
}

Tensor NumberAutoencoderImpl::bits(const Tensor& z) {
  return laplace_bits(z, torch::exp(log_spread.clamp(-2.5, 12.0))).sum(1);
}

void NumberAutoencoderImpl::initialise(const Tensor& x, double mse) {
  torch::NoGradGuard no_grad;
  const Tensor axes = principal_axes(x, analysis->weight.size(0));  // [M, N]
  const double step = step_for(mse);
  analysis->weight.copy_(axes / step);
  analysis->bias.zero_();
  synthesis->weight.copy_(axes.t() * step);
  synthesis->bias.zero_();
  const Tensor z = torch::mm(x, axes.t()) / step;  // [n, M]
  latent_scale.copy_((z.square().mean(0, true).sqrt() + 0.5));
  log_spread.copy_((z.abs().mean(0, true) + 0.1).log());
}

std::vector<Tensor> NumberAutoencoderImpl::linear_parameters() const {
  return {analysis->weight, analysis->bias, synthesis->weight, synthesis->bias};
}

AutoencoderImpl::AutoencoderImpl(const NetworkShape& network) : shape(network) {
  for (size_t i = 0; i < network.images.size(); ++i)
    images.push_back(
        register_module("image" + std::to_string(i), ImageAutoencoder(network.images[i], network)));
  if (network.numbers > 0)
    numbers =
        register_module("numbers", NumberAutoencoder(network.numbers, network.number_latents));
}

Parts AutoencoderImpl::encode(const Parts& values) {
  Parts latents;
  for (size_t i = 0; i < images.size(); ++i)
    latents.images.push_back(images[i]->encode(values.images[i]));
  if (numbers) latents.numbers = numbers->encode(values.numbers);
  return latents;
}

Parts AutoencoderImpl::decode(const Parts& latents) {
  Parts values;
  for (size_t i = 0; i < images.size(); ++i)
    values.images.push_back(images[i]->decode(latents.images[i], latents.numbers));
  if (numbers) values.numbers = numbers->decode(latents.numbers);
  return values;
}

}  // namespace engram::encoders
