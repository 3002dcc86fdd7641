// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "encoders/autoencoder.h"
#include "encoders/motion.h"

// Internal to the learning rooms: includes LibTorch. Letters as in autoencoder.h.

namespace engram::encoders {

/// What is expected of the latents of one grid before they are known. [B, z, h, w] each.
struct ExpectedLatents {
  torch::Tensor mean;
  torch::Tensor log_scale;  ///< Of a Laplace distribution around the mean.
  torch::Tensor features;   ///< What it was concluded from.
};

/// The distribution of the next latents of a grid, given the last two and what else is known.
/// Starts by expecting the last ones again.
///
///     last, last - before, known   [B, 2z + K', h, w]
///           | input 3x3, + added
///     [B, G, h, w]   block -- activate --> ExpectedLatents::features
///           | output 1x1
///     change of the mean, log scale   [B, z, h, w] each
///
/// z channels of the grid, h w its size, K' channels of `known`, G `features`.
/// Source: our own.
struct LatentPriorImpl : torch::nn::Module {
  LatentPriorImpl(int channels, int known, int features);

  /// `known` [B, K', h, w] or undefined; `added` [B, features] or undefined.
  ExpectedLatents forward(const torch::Tensor& last, const torch::Tensor& before,
                          const torch::Tensor& known, const torch::Tensor& added);

  torch::nn::Conv2d input{nullptr}, output{nullptr};
  ResidualBlock block{nullptr};
};
TORCH_MODULE(LatentPrior);

/// The prior of the latents of one image, how far its prediction is trusted per pixel, and what
/// predicts without latents.
///
///     last two coarse latents, features of numbers --> coarse_prior --> next coarse latents
///                                                           |  features [B, F/2, H/16, W/16]
///                                                           +--> gate_output --> gate [B, 1, H, W]
///     last two fine latents, next coarse latents ----> fine_prior ----> next fine latents
///     last two images, features of numbers and conditions --> motion --> next images
struct ImageDynamicsImpl : torch::nn::Module {
  ImageDynamicsImpl(const ImageShape& shape, const NetworkSizes& sizes, int number_features,
                    int motion_features);

  ExpectedLatents coarse(const ImageLatents& last, const ImageLatents& before,
                         const torch::Tensor& number_features);
  /// `then`: the coarse latents of the snapshot whose fine ones are asked for.
  ExpectedLatents fine(const ImageLatents& last, const ImageLatents& before,
                       const torch::Tensor& then);
  /// Of ExpectedLatents::features of coarse(): [B, 1, H, W], 0 to 1.
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

/// Expects the next latents from the last two: what makes them cheap, and what predicts.
///
///     value(k) = last + gate * (decode(z(k)) - decode(z))
///
/// so that a closed gate is a copy of the last value. Images are also predicted from their pixels
/// (ImageMotion), which carries over better to what the latents were not trained on.
///
///     numbers, their change [B, 2N] --> number_input -- number_hidden --> [B, 128]
///           --> number_change [B, N], number_gate [B, N]; images[i] as features of numbers
///     conditions, changes, plan [B, (2 + kSteps) K + 2] --> condition_input -- condition_hidden
///           --> [B, 64], for the motion of images alone
///
/// Source: docs/learning_methods.md, section "Prediction".
struct DynamicsImpl : torch::nn::Module {
  explicit DynamicsImpl(const NetworkShape& shape);

  /// Bits that the image latents `then` take after `last` and `before`. [B]
  torch::Tensor bits(const Latents& then, const Latents& last, const Latents& before);

  DynamicsStep step(const Latents& last, const Latents& before);

  /// What motion is told beside the images, for the steps that follow `ahead` ones: of the numbers,
  /// of the conditions, and of what is planned of these. Beyond its end a plan stands still.
  torch::Tensor motion_features(const Parts& last, const Parts& before, int ahead = 0);

  /// The images of the next `steps` steps as their motion goes on: per step, per image member, grey
  /// levels 0 to 255. None without networks.
  std::vector<std::vector<torch::Tensor>> move(const Parts& last, const Parts& before, int steps);

  NetworkShape shape;
  std::vector<ImageDynamics> images;
  torch::nn::Linear number_input{nullptr}, number_hidden{nullptr}, number_change{nullptr},
      number_gate{nullptr};
  torch::nn::Linear condition_input{nullptr}, condition_hidden{nullptr};

 private:
  /// Of normalised numbers [B, N]; undefined without numbers.
  torch::Tensor number_features(const torch::Tensor& last, const torch::Tensor& before);
  torch::Tensor condition_features(const Parts& last, const Parts& before, int ahead);
};
TORCH_MODULE(Dynamics);

/// Bits of the unit interval around a value `distance` from the mean of a Laplace distribution.
[[nodiscard]] torch::Tensor laplace_bits(const torch::Tensor& distance, const torch::Tensor& scale);

/// The values after each of `steps` (ascending) as the latents have them, from the last values and
/// the last two latents: what lies between stays latent, for decoding is most of what a step costs.
/// Values are grey levels (clamped to 0..255) and normalised numbers.
[[nodiscard]] std::vector<Parts> roll_out(Autoencoder& autoencoder, Dynamics& dynamics,
                                          const Parts& last, const Latents& now,
                                          const Latents& before, std::span<const int> steps);

}  // namespace engram::encoders
