// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "encoders/global_code.h"
#include "training/fit/divergence.h"
#include "training/fit/latent_regulariser.h"

namespace engram::training {

using encoders::Latents;
using torch::Tensor;

namespace {

/// Deviation of the prior of pooled latents. Unit: steps of the quantiser.
constexpr double kWaePriorDeviation = 4.0;
/// Price of a discrepancy of one. Unit: kilobytes per snapshot.
constexpr double kDiscrepancyPrice = 1.0;
/// Number of codes of earlier snapshots that are added to a batch, without gradients.
constexpr int64_t kRecentCodes = 256;

/// Pulls the distribution of codes, which are pooled latents along fixed random directions, towards
/// a unit Gaussian. The latents themselves are free. Codes of earlier batches are added, because
/// one batch has too few for the discrepancy.
class WaeRegulariser : public LatentRegulariser {
 public:
  explicit WaeRegulariser(const encoders::NetworkShape& shape) {
    const int64_t features = encoders::pooled_size(shape);
    const int64_t count = std::min(encoders::kGlobalCodeSize, features);
    directions_ = register_buffer("directions",
                                  std::get<0>(torch::linalg_qr(torch::randn({features, count}))));
    recent_ = register_buffer("recent", torch::zeros({0, count}));
  }

  RegularisedLatents regularise(const Latents& exact, bool is_noisy) override {
    const Tensor codes =
        torch::matmul(encoders::pooled_latents(exact), directions_) / kWaePriorDeviation;  // [B, K]
    const Tensor all = torch::cat({codes, recent_});
    const Tensor cost = kDiscrepancyPrice * mean_discrepancy(all, torch::randn_like(all));
    recent_.set_data(all.detach().slice(0, 0, kRecentCodes).clone());
    return {quantised(exact, is_noisy), stored(exact), cost};
  }

  [[nodiscard]] bool is_steered() const override { return false; }

 private:
  Tensor directions_;  ///< [F, K], orthonormal columns.
  Tensor recent_;      ///< [up to kRecentCodes, K], the newest first.
};

}  // namespace

std::shared_ptr<LatentRegulariser> make_wae_regulariser(const encoders::NetworkShape& shape) {
  return std::make_shared<WaeRegulariser>(shape);
}

}  // namespace engram::training
