// SPDX-License-Identifier: Apache-2.0
#include "training/fit/fit_dynamics.h"

#include <array>
#include <numeric>

#include "training/fit/gradients.h"
#include "training/fit/windows.h"

namespace engram::training {

using encoders::Parts;
using torch::Tensor;

namespace {

constexpr double kDynamicsRate = 1e-3;
constexpr double kMaxDynamicsGradient = 1.0;
/// Horizons that rollouts are trained for.
constexpr int kTrainedHorizons = 2;

Tensor error_of(const Parts& predicted, const Parts& actual) {
  constexpr double kUnit = encoders::kGreyLevels * encoders::kGreyLevels;
  Tensor error = torch::zeros({});
  for (size_t i = 0; i < actual.images.size(); ++i)
    error = error + (predicted.images[i] - actual.images[i]).square().mean() / kUnit * 10.0;
  if (actual.numbers.defined())
    error = error + (predicted.numbers - actual.numbers).square().mean();
  return error;
}

}  // namespace

Result<FitStep> fit_dynamics(encoders::DeepModel& model, const Dataset& data,
                             const LatentTable& latents, const TrainOptions& options,
                             FitLoop& loop) {
  FitStep result;
  Smoothed loss_mean(0.05);
  const auto rows = make_windows(data.sequences, data.first_held_out, kTrainedHorizons).training;
  if (rows.empty() || model.dynamics->parameters().empty()) return result;
  const FrozenParameters frozen(*model.autoencoder);
  torch::optim::Adam optimiser(model.dynamics->parameters(),
                               torch::optim::AdamOptions(kDynamicsRate));
  const Tensor windows = torch::tensor(rows, torch::kLong);
  std::array<int, kTrainedHorizons> horizons{};
  std::iota(horizons.begin(), horizons.end(), 1);
  FitState state{model, optimiser, result, loss_mean.state()};
  ENGRAM_RETURN_IF_ERROR(loop.begin(state));
  for (;; ++result.step) {
    ENGRAM_ASSIGN_OR_RETURN(const double share, loop.next(state));
    if (share >= 1.0) break;
    const Tensor now = windows.index_select(
        0, torch::randint(windows.size(0), {options.batch_size}, torch::kLong));
    auto& group = optimiser.param_groups()[0].options();
    static_cast<torch::optim::AdamOptions&>(group).lr(kDynamicsRate * learning_rate_share(share));
    forget_gradients(optimiser);
    const auto futures = encoders::roll_out(model.autoencoder, model.dynamics,
                                            data.batch(model.autoencoder->shape, now),
                                            latents.rows(now), latents.rows(now - 1), horizons);
    Tensor loss = torch::zeros({});
    for (size_t i = 0; i < futures.size(); ++i)
      loss = loss + error_of(futures[i], data.batch(model.autoencoder->shape,
                                                    now + static_cast<int64_t>(i + 1)));
    loss.backward();
    torch::nn::utils::clip_grad_norm_(model.dynamics->parameters(), kMaxDynamicsGradient);
    optimiser.step();
    loss_mean.add(loss.item<double>());
    result.loss = loss_mean.value();
    loop.tell(result);
  }
  return result;
}

}  // namespace engram::training
