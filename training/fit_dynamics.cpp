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

/// Shares of images that are tried: of latents and of motion, together at most all.
std::vector<encoders::Shares> image_shares() {
  std::vector<encoders::Shares> shares;
  for (const double latents : kGates)
    for (const double motion : kGates)
      if (latents + motion <= 1) shares.push_back({latents, motion, 0});
  return shares;
}

/// Sums over the measured windows for one horizon, of each share and of the truth.
struct GateSums {
  std::vector<encoders::Shares> shares = image_shares();  ///< The first one copies.
  std::vector<double> image_mse = std::vector<double>(shares.size());
  std::vector<double> psnr = std::vector<double>(shares.size());
  std::array<double, kGates.size()> number_mse{};
  double count = 0;

  void add(const encoders::DeepModel& model, const Parts& last, const encoders::Future& future,
           const Parts& actual) {
    for (size_t g = 0; g < shares.size(); ++g) {
      const double mse = image_error(encoders::mix(last, future, shares[g]), actual);
      image_mse[g] += mse;
      psnr[g] += psnr_db(mse);
    }
    for (size_t g = 0; g < kGates.size(); ++g)
      number_mse[g] += number_error(model, encoders::mix(last, future, {0, 0, kGates[g]}), actual);
    count += 1;
  }

  /// The highest PSNR that does not lose in squared error.
  [[nodiscard]] size_t best_for_images() const {
    size_t best = 0;
    for (size_t g = 1; g < shares.size(); ++g)
      if (psnr[g] > psnr[best] && image_mse[g] <= image_mse[0]) best = g;
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

void keep_best(const encoders::DeepModel& model, const GateSums& sums, size_t horizon,
               encoders::PredictionRecord& record) {
  if (sums.count == 0) return;
  const size_t image = sums.best_for_images();
  const size_t number = sums.best_for_numbers();
  if (!model.plan.images().empty()) {
    record.image_gates[horizon] = sums.shares[image].latents;
    record.motion_gates[horizon] = sums.shares[image].motion;
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

namespace {

void measure(encoders::DeepModel& model, const Dataset& data, bool has_conditions,
             encoders::PredictionRecord& record) {
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
    Parts last = data.batch(shape, index_of(row));
    Parts before = data.batch(shape, index_of(row - 1));
    if (!has_conditions) last.conditions = before.conditions = Tensor();
    const auto futures = encoders::futures_of(model, last, before, steps);
    for (size_t i = 0; i < futures.size(); ++i)
      sums[i].add(model, last, futures[i],
                  data.batch(shape, index_of(row + static_cast<int64_t>(i) + 1)));
  }
  for (size_t i = 0; i < sums.size(); ++i) keep_best(model, sums[i], i, record);
  // Horizons that no recording is long enough for are as uncertain as the last that was measured.
  for (size_t i = 1; i < sums.size(); ++i)
    if (sums[i].count == 0) record.expected[i] = record.expected[i - 1];
}

}  // namespace

void measure_prediction(encoders::DeepModel& model, const Dataset& data) {
  torch::NoGradGuard no_grad;
  measure(model, data, true, model.prediction);
  if (model.condition) measure(model, data, false, model.unconditioned);
}

}  // namespace engram::training
