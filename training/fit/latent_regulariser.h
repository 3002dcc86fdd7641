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

// One function per variant. In the equations, z are the exact latents, E is the squared error and p
// its price.

/// "rate": the loss is p E + bits(z + u), with u uniform in [-1/2, 1/2], later with rounding.
/// Source: Ballé et al., End-to-end Optimized Image Compression, 2017. The model of the bits is our
/// own (encoders/dynamics.h).
[[nodiscard]] std::shared_ptr<LatentRegulariser> make_rate_regulariser();

/// "ae": the loss is p E alone. The latents are quantised as in "rate".
[[nodiscard]] std::shared_ptr<LatentRegulariser> make_plain_regulariser();

/// "vae": the loss is p E + sum of KL(N(z, s^2), N(0, 8^2)) in kilobytes, where
///
///     KL = (s^2/64 + z^2/64 - 1 - ln(s^2/64)) / 2 nats,
///
/// and the decoder is given z + s n, with n from N(0, 1).
/// Source: Kingma and Welling, Auto-Encoding Variational Bayes, 2014. There s is a function of the
/// input; here it is one parameter per channel, of at least half a step of the quantiser, because
/// only z is stored, rounded.
[[nodiscard]] std::shared_ptr<LatentRegulariser> make_vae_regulariser(
    const encoders::NetworkShape& shape);

/// "wae": the loss is p E + MMD^2(codes, N(0, 1)), with the kernel of mean_discrepancy()
/// (divergence.h). The latents are quantised as in "rate".
/// Source: Tolstikhin et al., Wasserstein Auto-Encoders, 2018 (WAE-MMD). There all latents of a
/// batch are compared; here codes are pooled coarse latents along fixed random directions, and the
/// last 256 before the batch count too, because a batch is small.
[[nodiscard]] std::shared_ptr<LatentRegulariser> make_wae_regulariser(
    const encoders::NetworkShape& shape);

/// Quantises latents in training: rounds them and passes gradients straight through (Theis et al.,
/// Lossy Image Compression with Compressive Autoencoders, 2017), or adds uniform noise of the same
/// size (Ballé et al., 2017).
[[nodiscard]] encoders::Latents quantised(const encoders::Latents& exact, bool is_noisy);

/// Rounds latents as they will be stored, without gradients.
[[nodiscard]] encoders::Latents stored(const encoders::Latents& exact);

}  // namespace engram::training
