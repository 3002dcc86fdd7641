// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "training/fit.h"
#include "training/metrics.h"

namespace engram::training {

using encoders::Parts;
using torch::Tensor;

namespace {

constexpr double kPeakRate = 1e-3;
constexpr double kLargestGradient = 1.0;
constexpr double kHeldOutShare = 0.15;
/// Horizons that rollouts are trained for.
constexpr int kTrainedHorizons = 2;
constexpr size_t kMostMeasuredWindows = 256;
constexpr std::array<double, 5> kGates{0.0, 0.25, 0.5, 0.75, 1.0};

Tensor error_of(const Parts& predicted, const Parts& actual) {
  constexpr double kUnit = encoders::kGreyLevels * encoders::kGreyLevels;
  Tensor error = torch::zeros({});
  for (size_t i = 0; i < actual.images.size(); ++i)
    error = error + (predicted.images[i] - actual.images[i]).square().mean() / kUnit * 10.0;
  if (actual.numbers.defined())
    error = error + (predicted.numbers - actual.numbers).square().mean();
  return error;
}

/// Sums over the measured windows for one horizon, of each gate and of the truth.
struct GateSums {
  std::array<double, kGates.size()> image_mse{};
  std::array<double, kGates.size()> psnr{};
  std::array<double, kGates.size()> number_mse{};
  double count = 0;

  void add(const encoders::DeepModel& model, const Parts& last, const Parts& predicted,
           const Parts& actual) {
    for (size_t g = 0; g < kGates.size(); ++g) {
      const Parts mixed = encoders::mix(last, predicted, kGates[g], kGates[g]);
      const double mse = image_error(mixed, actual);
      image_mse[g] += mse;
      psnr[g] += psnr_db(mse);
      number_mse[g] += number_error(model, mixed, actual);
    }
    count += 1;
  }

  /// Where the gate wins in squared error without losing in PSNR.
  [[nodiscard]] size_t best_for_images() const {
    size_t best = 0;
    for (size_t g = 1; g < kGates.size(); ++g)
      if (image_mse[g] < image_mse[best] && psnr[g] >= psnr[0]) best = g;
    return best;
  }

  [[nodiscard]] size_t best_for_numbers() const {
    return static_cast<size_t>(std::min_element(number_mse.begin(), number_mse.end()) -
                               number_mse.begin());
  }

 private:
  static double image_error(const Parts& predicted, const Parts& actual) {
    double sum = 0;
    double count = 0;
    for (size_t i = 0; i < actual.images.size(); ++i) {
      const Tensor rounded = predicted.images[i].round().clamp(0, 255);
      sum += (rounded - actual.images[i]).square().sum().item<double>();
      count += static_cast<double>(rounded.numel());
    }
    return count > 0 ? sum / count : 0;
  }

  static double number_error(const encoders::DeepModel& model, const Parts& predicted,
                             const Parts& actual) {
    if (!actual.numbers.defined()) return 0;
    const Tensor deviation = torch::tensor(model.deviation);
    return ((predicted.numbers - actual.numbers).to(torch::kFloat64) * deviation)
        .square()
        .mean()
        .item<double>();
  }
};

Tensor index_of(int64_t row) {
  return torch::tensor({row}, torch::kLong);
}

void keep_best(encoders::DeepModel& model, const GateSums& sums, size_t horizon) {
  if (sums.count == 0) return;
  const size_t image = sums.best_for_images();
  const size_t number = sums.best_for_numbers();
  auto& record = model.prediction;
  if (!model.plan.images().empty()) {
    record.image_gates[horizon] = kGates[image];
    record.expected[horizon].image_mse = sums.image_mse[image] / sums.count;
  }
  if (model.plan.number_count() > 0) {
    record.number_gates[horizon] = kGates[number];
    record.expected[horizon].number_mse = sums.number_mse[number] / sums.count;
  }
}

}  // namespace

size_t held_out_from(const Sequence& sequence) {
  const auto held_out =
      static_cast<size_t>(std::ceil(kHeldOutShare * static_cast<double>(sequence.size())));
  return sequence.end - std::min(held_out, sequence.size());
}

Windows make_windows(std::span<const Sequence> sequences, int horizon) {
  Windows windows;
  const auto ahead = static_cast<size_t>(horizon);
  for (const Sequence& sequence : sequences) {
    const size_t limit = held_out_from(sequence);
    for (size_t row = sequence.first + 1; row + ahead < sequence.end; ++row) {
      if (row + ahead < limit)
        windows.training.push_back(static_cast<int64_t>(row));
      else
        windows.held_out.push_back(static_cast<int64_t>(row));
    }
  }
  return windows;
}

Result<FitStep> fit_dynamics(encoders::DeepModel& model, const Dataset& data,
                             const LatentTable& latents, const TrainOptions& options,
                             FitLoop& loop) {
  FitStep result;
  Smoothed loss_mean(0.05);
  const auto rows = make_windows(data.sequences, kTrainedHorizons).training;
  if (rows.empty() || model.dynamics->parameters().empty()) return result;
  const Frozen frozen(*model.autoencoder);
  torch::optim::Adam optimiser(model.dynamics->parameters(), torch::optim::AdamOptions(kPeakRate));
  const Tensor windows = torch::tensor(rows, torch::kLong);
  FitState state{model, optimiser, result, loss_mean.state()};
  ENGRAM_RETURN_IF_ERROR(loop.begin(state));
  for (;; ++result.step) {
    ENGRAM_ASSIGN_OR_RETURN(const double share, loop.next(state));
    if (share >= 1.0) break;
    const Tensor now = windows.index_select(
        0, torch::randint(windows.size(0), {options.batch_size}, torch::kLong));
    auto& group = optimiser.param_groups()[0].options();
    static_cast<torch::optim::AdamOptions&>(group).lr(kPeakRate * learning_rate_share(share));
    optimiser.zero_grad();
    const auto futures = encoders::roll_out(
        model.autoencoder, model.dynamics, data.batch(model.autoencoder->shape, now),
        latents.rows(now), latents.rows(now - 1), kTrainedHorizons);
    Tensor loss = torch::zeros({});
    for (size_t i = 0; i < futures.size(); ++i)
      loss = loss + error_of(futures[i], data.batch(model.autoencoder->shape,
                                                    now + static_cast<int64_t>(i + 1)));
    loss.backward();
    torch::nn::utils::clip_grad_norm_(model.dynamics->parameters(), kLargestGradient);
    optimiser.step();
    loss_mean.add(loss.item<double>());
    result.loss = loss_mean.value();
    loop.tell(result);
  }
  return result;
}

Status measure_prediction(encoders::DeepModel& model, const Dataset& data) {
  torch::NoGradGuard no_grad;
  const auto& shape = model.autoencoder->shape;
  std::vector<int64_t> rows = make_windows(data.sequences, 1).held_out;
  const size_t stride = std::max<size_t>(1, rows.size() / kMostMeasuredWindows);
  std::array<GateSums, encoders::kMeasuredHorizons> sums;
  for (size_t w = 0; w < rows.size(); w += stride) {
    const int64_t row = rows[w];
    const auto sequence = std::find_if(data.sequences.begin(), data.sequences.end(),
                                       [&](auto& s) { return static_cast<size_t>(row) < s.end; });
    const int steps = static_cast<int>(std::min<size_t>(
        encoders::kMeasuredHorizons, sequence->end - 1 - static_cast<size_t>(row)));
    const Parts last = data.batch(shape, index_of(row));
    const auto now = encoders::round(model.autoencoder->encode(last));
    const auto before =
        encoders::round(model.autoencoder->encode(data.batch(shape, index_of(row - 1))));
    const auto futures =
        encoders::roll_out(model.autoencoder, model.dynamics, last, now, before, steps);
    for (size_t i = 0; i < futures.size(); ++i)
      sums[i].add(model, last, futures[i],
                  data.batch(shape, index_of(row + static_cast<int64_t>(i) + 1)));
  }
  for (size_t i = 0; i < sums.size(); ++i) keep_best(model, sums[i], i);
  // Horizons that no recording is long enough for are as uncertain as the last that was measured.
  for (size_t i = 1; i < sums.size(); ++i)
    if (sums[i].count == 0) model.prediction.expected[i] = model.prediction.expected[i - 1];
  return {};
}

}  // namespace engram::training
