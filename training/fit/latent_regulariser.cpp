// SPDX-License-Identifier: Apache-2.0
#include "training/fit/latent_regulariser.h"

#include "ltm/core/check.h"

namespace engram::training {

using encoders::Latents;
using encoders::TrainingVariant;
using torch::Tensor;

namespace {

/// The cost of latents is bits alone, so gradients of the prior reach the encoder.
class RateRegulariser : public LatentRegulariser {
 public:
  RegularisedLatents regularise(const Latents& exact, bool is_noisy) override {
    const Latents latents = quantised(exact, is_noisy);
    return {latents, latents, torch::zeros({})};
  }
  [[nodiscard]] bool is_steered() const override { return true; }
};

/// Latents have no cost.
class PlainRegulariser : public LatentRegulariser {
 public:
  RegularisedLatents regularise(const Latents& exact, bool is_noisy) override {
    return {quantised(exact, is_noisy), stored(exact), torch::zeros({})};
  }
  [[nodiscard]] bool is_steered() const override { return false; }
};

Tensor with_rounding(const Tensor& z, bool is_noisy) {
  if (is_noisy) return z + torch::rand_like(z) - 0.5;
  return z + (z.round() - z).detach();
}

}  // namespace

Latents quantised(const Latents& exact, bool is_noisy) {
  Latents latents{{}, exact.numbers, exact.scene};
  for (const auto& image : exact.images)
    latents.images.push_back(
        {with_rounding(image.coarse, is_noisy), with_rounding(image.fine, is_noisy)});
  return latents;
}

Latents stored(const Latents& exact) {
  torch::NoGradGuard no_grad;
  return encoders::round(exact);
}

std::shared_ptr<LatentRegulariser> make_rate_regulariser() {
  return std::make_shared<RateRegulariser>();
}

std::shared_ptr<LatentRegulariser> make_plain_regulariser() {
  return std::make_shared<PlainRegulariser>();
}

std::shared_ptr<LatentRegulariser> make_latent_regulariser(TrainingVariant variant,
                                                           const encoders::NetworkShape& shape) {
  switch (variant) {
    case TrainingVariant::kRateAware:
      return make_rate_regulariser();
    case TrainingVariant::kAutoencoder:
      return make_plain_regulariser();
    case TrainingVariant::kVae:
      return make_vae_regulariser(shape);
    case TrainingVariant::kWae:
      return make_wae_regulariser(shape);
  }
  ENGRAM_CHECK(false, "no variant {}", static_cast<int>(variant));
  return nullptr;
}

}  // namespace engram::training
