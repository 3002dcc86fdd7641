// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "encoders/autoencoder.h"
#include "encoders/motion.h"

// Internal to the learning rooms: includes LibTorch. Letters as in autoencoder.h.

namespace engram::encoders {

/// The expected latents of one grid before they are known.
/// Shape: [B, z, h, w] for the mean and the scale, [B, G, h, w] for the features (letters of
/// LatentPrior).
struct ExpectedLatents {
  torch::Tensor mean;
  torch::Tensor log_scale;  ///< Of a Laplace distribution around the mean.
  torch::Tensor features;   ///< Features from which both were computed.
};

/// Predicts the distribution of the next latents of a grid from the last two and other known
/// features. Before training it expects the last latents again.
///
///     last, last - before, known   [B, 2z + K', h, w]
///           | input 3x3, + added
///     [B, G, h, w]   block -- activate --> ExpectedLatents::features
///           | output 1x1
///     change of the mean, log scale   [B, z, h, w] each
///
/// B is the batch, z the channels of the grid, h and w its size, K' the channels of `known`, and G
/// is `features`.
/// Source: our own network. Each latent has a mean and a scale as in Minnen et al., Joint
/// Autoregressive and Hierarchical Priors for Learned Image Compression, 2018. There they come from
/// latents of the same image alone, here from those of the last two snapshots too.
struct LatentPriorImpl : torch::nn::Module {
  LatentPriorImpl(int channels, int known, int features);

  /// Shape: `last` and `before` [B, z, h, w]; `known` [B, K', h, w] or undefined; `added` [B, G] or
  /// undefined.
  ExpectedLatents forward(const torch::Tensor& last, const torch::Tensor& before,
                          const torch::Tensor& known, const torch::Tensor& added);

  torch::nn::Conv2d input{nullptr}, output{nullptr};
  ResidualBlock block{nullptr};
};
TORCH_MODULE(LatentPrior);

/// The predictors of one image member: a prior of its latents, a gate that says per pixel how far
/// that prediction is trusted, and a network of motion that needs no latents.
///
///     last two coarse latents, features of numbers --> coarse_prior --> next coarse latents
///                                                           |  features [B, F/2, H/16, W/16]
///                                                           +--> gate_output --> gate [B, 1, H, W]
///     last two fine latents, next coarse latents ----> fine_prior ----> next fine latents
///     last two images, features of numbers and conditions --> motion --> next images
///
/// Letters are those of autoencoder.h.
/// Source: docs/learning_methods.md, section "Prediction". The priors and the gate are our own; the
/// papers that `motion` follows are named at ImageMotion.
struct ImageDynamicsImpl : torch::nn::Module {
  ImageDynamicsImpl(const ImageShape& shape, const NetworkSizes& sizes, int number_features,
                    int motion_features);

  ExpectedLatents coarse(const ImageLatents& last, const ImageLatents& before,
                         const torch::Tensor& number_features);
  /// `then` are the coarse latents of the snapshot whose fine latents are predicted.
  ExpectedLatents fine(const ImageLatents& last, const ImageLatents& before,
                       const torch::Tensor& then);
  /// Computes the gate from the features that coarse() returned. Its values are 0 to 1.
  /// Shape: [B, 1, H, W].
  torch::Tensor gate(const torch::Tensor& features);

  int stride;
  LatentPrior coarse_prior{nullptr}, fine_prior{nullptr};
  torch::nn::Conv2d gate_output{nullptr};
  torch::nn::Linear from_numbers{nullptr};
  ImageMotion motion{nullptr};
};
TORCH_MODULE(ImageDynamics);

/// One step of the dynamics.
struct DynamicsStep {
  Latents then;
  std::vector<torch::Tensor> gates;  ///< Per image [B, 1, H, W], 0 to 1.
  torch::Tensor number_gate;         ///< [B, N], 0 to 1; undefined without numbers.
};

/// Predicts the next latents from the last two. The same prediction makes latents cheap to store
/// and predicts future values.
///
///     value(k) = last + gate * (decode(z(k)) - decode(z))
///
/// A closed gate therefore copies the last value. Images are also predicted from their pixels
/// (ImageMotion), which generalises better to scenes that the latents were not trained on.
///
///     numbers, their change [B, 2N] --> number_input -- number_hidden --> [B, 128]
///           --> number_change [B, N], number_gate [B, N]; images[i] as features of numbers
///     conditions, changes, plan [B, (2 + kSteps) K + 2] --> condition_input -- condition_hidden
///           --> [B, 64], for the motion of images alone
///
/// kSteps is ImageMotionImpl::kSteps; the last two inputs say whether condition and plan are known.
/// Letters are those of autoencoder.h.
/// Source: docs/learning_methods.md, section "Prediction". Latents cost the bits that a model of
/// their distribution says, as in Ballé et al., End-to-end Optimized Image Compression, 2017. That
/// this model also predicts the future, and that gates blend it with a copy, is our own.
struct DynamicsImpl : torch::nn::Module {
  explicit DynamicsImpl(const NetworkShape& shape);

  /// Number of bits of the image latents `then` after `last` and `before`.
  /// Shape: [B].
  torch::Tensor bits(const Latents& then, const Latents& last, const Latents& before);

  DynamicsStep step(const Latents& last, const Latents& before);

  /// Features that the network of motion gets beside the images for the steps after the first
  /// `ahead` ones: features of the numbers, of the conditions and of their plan. Beyond its end a
  /// plan keeps its last values.
  torch::Tensor motion_features(const Parts& last, const Parts& before, int ahead = 0);

  /// Predicts the images of the next `steps` steps from motion: per step and image member, in grey
  /// levels from 0 to 255. The result is empty without networks.
  std::vector<std::vector<torch::Tensor>> move(const Parts& last, const Parts& before, int steps);

  NetworkShape shape;
  std::vector<ImageDynamics> images;
  torch::nn::Linear number_input{nullptr}, number_hidden{nullptr}, number_change{nullptr},
      number_gate{nullptr};
  torch::nn::Linear condition_input{nullptr}, condition_hidden{nullptr};

 private:
  /// Takes normalised numbers [B, N]; the result is undefined without numbers.
  torch::Tensor number_features(const torch::Tensor& last, const torch::Tensor& before);
  torch::Tensor condition_features(const Parts& last, const Parts& before, int ahead);
};
TORCH_MODULE(Dynamics);

/// Number of bits of the unit interval around a value at `distance` d from the mean of a Laplace
/// distribution with distribution function F:
///
///     -log2(F(d + 1/2) - F(d - 1/2))
///
/// It is bounded, because the probability counts as at least 1e-7.
/// Source: the rate of Ballé et al., 2017, with a Laplace distribution.
[[nodiscard]] torch::Tensor laplace_bits(const torch::Tensor& distance, const torch::Tensor& scale);

/// Predicts the values after each of `steps` (ascending) from the last values and the last two
/// latents. Steps in between are not decoded, because decoding is most of the cost of a step.
/// Values are grey levels (clamped to 0..255) and normalised numbers.
[[nodiscard]] std::vector<Parts> roll_out(Autoencoder& autoencoder, Dynamics& dynamics,
                                          const Parts& last, const Latents& now,
                                          const Latents& before, std::span<const int> steps);

}  // namespace engram::encoders
