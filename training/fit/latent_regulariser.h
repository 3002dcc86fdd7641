// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "encoders/autoencoder.h"
#include "encoders/training_variant.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// The latents of a batch as training uses them.
struct RegularisedLatents {
  encoders::Latents decoded;  ///< Input of the decoder.
  /// Input of the prior. It has no gradients to the encoder in variants whose encoder does not
  /// learn from bits.
  encoders::Latents coded;
  /// Cost besides squared error and bits, for every row [B] or as one number. Unit: kilobytes per
  /// snapshot.
  torch::Tensor cost;
};

/// The treatment of latents between encoder and decoder in a training variant, and their cost.
///
/// Learned values are its parameters, and state is in its buffers.
/// Source: docs/learning_methods.md, section "Training variants".
class LatentRegulariser : public torch::nn::Module {
 public:
  /// `exact` are the latents of the encoder. With `is_noisy`, a variant that rounds adds noise
  /// instead.
  /// Shape: [B, z, h, w] for each grid.
  virtual RegularisedLatents regularise(const encoders::Latents& exact, bool is_noisy) = 0;

  /// Whether the price of squared error follows the requested PSNR. Else it is constant.
  [[nodiscard]] virtual bool is_steered() const = 0;
};

/// Makes the regulariser of a variant, which is never null. It uses LibTorch's random generator.
[[nodiscard]] std::shared_ptr<LatentRegulariser> make_latent_regulariser(
    encoders::TrainingVariant variant, const encoders::NetworkShape& shape);

/// One function per variant.
[[nodiscard]] std::shared_ptr<LatentRegulariser> make_rate_regulariser();
[[nodiscard]] std::shared_ptr<LatentRegulariser> make_plain_regulariser();
[[nodiscard]] std::shared_ptr<LatentRegulariser> make_vae_regulariser(
    const encoders::NetworkShape& shape);
[[nodiscard]] std::shared_ptr<LatentRegulariser> make_wae_regulariser(
    const encoders::NetworkShape& shape);

/// Quantises latents in training: rounds them and passes gradients straight through, or adds
/// uniform noise of the same size.
[[nodiscard]] encoders::Latents quantised(const encoders::Latents& exact, bool is_noisy);

/// Rounds latents as they will be stored, without gradients.
[[nodiscard]] encoders::Latents stored(const encoders::Latents& exact);

}  // namespace engram::training
