// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "encoders/autoencoder.h"

// Internal to the learning rooms: includes LibTorch. Letters as in autoencoder.h.

namespace engram::encoders {

/// One step of the dynamics in latent space.
struct DynamicsStep {
  Parts change;                      ///< To be added to the latents.
  std::vector<torch::Tensor> gates;  ///< Per image [B, 1, H, W], 0 to 1.
  torch::Tensor number_gate;         ///< [B, N], 0 to 1; undefined without numbers.
};

/// The next latents of one image from the last two; starts by changing nothing.
struct ImageDynamicsImpl : torch::nn::Module {
  ImageDynamicsImpl(const ImageShape& shape, const NetworkShape& network, int number_features);

  /// `now`, `before`: [B, Z, h, w] divided by their scale; `features` [B, K] or undefined.
  /// Returns the change [B, Z, h, w] and the gate [B, 1, H, W].
  std::pair<torch::Tensor, torch::Tensor> forward(const torch::Tensor& now,
                                                  const torch::Tensor& before,
                                                  const torch::Tensor& features);

  int stride;
  torch::nn::Conv2d input{nullptr}, change{nullptr}, gate{nullptr};
  torch::nn::Linear from_numbers{nullptr};
  ResidualBlock block_1{nullptr}, block_2{nullptr};
};
TORCH_MODULE(ImageDynamics);

/// Continues the latents of one entity:
///
///     value(k) = last + gate * (decode(z + changes) - decode(z))
///
/// so that a closed gate is a copy of the last value.
/// Source: docs/learning.md, section "Prediction".
struct DynamicsImpl : torch::nn::Module {
  explicit DynamicsImpl(const NetworkShape& shape);

  /// `now`, `before`: latents as Autoencoder::encode gives them.
  DynamicsStep forward(Autoencoder& autoencoder, const Parts& now, const Parts& before);

  NetworkShape shape;
  std::vector<ImageDynamics> images;
  torch::nn::Linear number_input{nullptr}, number_hidden{nullptr}, number_change{nullptr},
      number_gate{nullptr};
};
TORCH_MODULE(Dynamics);

/// The values after `steps` steps, for every step, from the last values and the last two latents.
/// Values are grey levels (clamped to 0..255) and normalised numbers.
[[nodiscard]] std::vector<Parts> roll_out(Autoencoder& autoencoder, Dynamics& dynamics,
                                          const Parts& last, const Parts& now, const Parts& before,
                                          int steps);

}  // namespace engram::encoders
