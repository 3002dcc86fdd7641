// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "encoders/autoencoder.h"
#include "encoders/training_variant.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// The latents of a batch as training uses them.
struct RegularisedLatents {
  encoders::Latents decoded;  ///< What the decoder is given.
  /// What the prior is told. Without gradients to the encoder where bits teach it nothing.
  encoders::Latents coded;
  /// Beside squared error and bits, of every row [B] or of one number. Unit: kilobytes a snapshot.
  torch::Tensor cost;
};

/// What a training variant does with latents between encoder and decoder, and what they cost.
///
/// What is learned of it are its parameters, what it remembers are its buffers.
/// Source: docs/learning.md, section "Training variants".
class LatentRegulariser : public torch::nn::Module {
 public:
  /// Shape: `exact` as the encoder made them, [B, z, h, w] of each grid.
  /// `is_noisy`: noise stands in for rounding, where the variant rounds.
  virtual RegularisedLatents regularise(const encoders::Latents& exact, bool is_noisy) = 0;

  /// Whether the price of squared error follows the PSNR that was asked for; else it stays.
  [[nodiscard]] virtual bool is_steered() const = 0;
};

/// Never null. Draws from LibTorch's random generator.
[[nodiscard]] std::shared_ptr<LatentRegulariser> make_latent_regulariser(
    encoders::TrainingVariant variant, const encoders::NetworkShape& shape);

/// One per variant.
[[nodiscard]] std::shared_ptr<LatentRegulariser> make_rate_regulariser();
[[nodiscard]] std::shared_ptr<LatentRegulariser> make_plain_regulariser();
[[nodiscard]] std::shared_ptr<LatentRegulariser> make_vae_regulariser(
    const encoders::NetworkShape& shape);
[[nodiscard]] std::shared_ptr<LatentRegulariser> make_wae_regulariser(
    const encoders::NetworkShape& shape);

/// Latents to be rounded later: rounded with gradients passed straight through, or with noise of
/// the same size.
[[nodiscard]] encoders::Latents quantised(const encoders::Latents& exact, bool is_noisy);

/// Rounded, without gradients: what will be stored.
[[nodiscard]] encoders::Latents stored(const encoders::Latents& exact);

}  // namespace engram::training
