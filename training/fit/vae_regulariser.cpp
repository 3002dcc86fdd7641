// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "training/fit/divergence.h"
#include "training/fit/latent_regulariser.h"

namespace engram::training {

using encoders::Latents;
using torch::Tensor;

namespace {

/// Deviation of the prior. Unit: steps of the quantiser.
constexpr double kVaePriorDeviation = 8.0;
/// Min deviation of a posterior in the same unit. Rounding adds a deviation of 0.29, which is less
/// than the decoder was trained with.
constexpr double kMinDeviation = 0.5;
/// First deviation, as a logit between these two on a logarithmic scale (it stands for one step),
/// and the speed of deviations relative to weights.
constexpr double kFirstLogit = -1.0986;
constexpr double kDeviationSpeed = 10.0;
constexpr double kNatsPerKilobyte = 8000.0 * std::numbers::ln2;

/// Uses a Gaussian posterior around each latent, with one deviation per channel, and a Gaussian
/// prior of all latents. The mean is stored.
class VaeRegulariser : public LatentRegulariser {
 public:
  explicit VaeRegulariser(const encoders::NetworkShape& shape) {
    for (size_t i = 0; i < shape.images.size(); ++i) {
      const auto grids = shape.grids(i);
      deviations_.push_back({make_logits("coarse" + std::to_string(i), grids[0].channels),
                             make_logits("fine" + std::to_string(i), grids[1].channels)});
    }
  }

  RegularisedLatents regularise(const Latents& exact, bool /*is_noisy*/) override {
    RegularisedLatents result{{{}, exact.numbers, exact.scene}, stored(exact), torch::zeros({})};
    for (size_t i = 0; i < exact.images.size(); ++i)
      result.decoded.images.push_back(
          {sampled(exact.images[i].coarse, deviations_[i].coarse, result.cost),
           sampled(exact.images[i].fine, deviations_[i].fine, result.cost)});
    return result;
  }

  [[nodiscard]] bool is_steered() const override { return true; }

 private:
  Tensor make_logits(const std::string& name, int channels) {
    return register_parameter("deviation_" + name, torch::zeros({1, channels, 1, 1}));
  }

  /// Samples the posterior and adds its divergence from the prior to `kilobytes`.
  static Tensor sampled(const Tensor& mean, const Tensor& logit, Tensor& kilobytes) {
    const double range = std::log(kVaePriorDeviation / kMinDeviation);
    const Tensor below_prior =  // Logarithm of the posterior's deviation over the prior's.
        range * (torch::sigmoid(kFirstLogit + kDeviationSpeed * logit) - 1.0);
    const Tensor nats = gaussian_divergence(mean / kVaePriorDeviation, 2.0 * below_prior);
    kilobytes = kilobytes + nats.sum({1, 2, 3}) / kNatsPerKilobyte;  // [B]
    return mean + kVaePriorDeviation * below_prior.exp() * torch::randn_like(mean);
  }

  std::vector<encoders::ImageLatents> deviations_;  ///< Logits [1, z, 1, 1] of each grid.
};

}  // namespace

std::shared_ptr<LatentRegulariser> make_vae_regulariser(const encoders::NetworkShape& shape) {
  return std::make_shared<VaeRegulariser>(shape);
}

}  // namespace engram::training
