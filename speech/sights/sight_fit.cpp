// SPDX-License-Identifier: Apache-2.0
#include "speech/sights/sight_fit.h"

#include <algorithm>
#include <cmath>

#include "speech/sights/sight_reading.h"

namespace engram::speech {

namespace {

namespace nn = torch::nn::functional;

constexpr double kWeightDecay = 0.01;
constexpr int64_t kWarmUpSteps = 100;
/// Most cells show nothing.
constexpr double kWeightOfNothing = 0.3;
constexpr double kSmoothing = 0.02;
constexpr double kPlaceShare = 0.5;
constexpr double kColourShare = 0.5;
constexpr int64_t kMeasuredTogether = 64;
constexpr int kLimits = 46;
constexpr int64_t kLossOver = 100;

/// What is told of the kind in each cell, from what is told of each kind in the image; not learned
/// where there is no thing. Shape: kinds [B, R, C], told [B, kinds] -> [B, R, C].
torch::Tensor at_cells(const torch::Tensor& kinds, const torch::Tensor& told) {
  const int64_t nothing = told.size(1);
  const torch::Tensor is_thing = kinds.ge(0).logical_and(kinds.lt(nothing));
  const torch::Tensor index = kinds.clamp(0, nothing - 1).flatten(1);
  const torch::Tensor values = told.gather(1, index).view_as(kinds);
  return torch::where(is_thing, values, torch::full_like(values, SightBatch::kNotLearned));
}

/// The mean over cells that are learned; zero where there are none.
torch::Tensor loss_of_cells(const torch::Tensor& logits, const torch::Tensor& wanted) {
  const torch::Tensor sum = nn::cross_entropy(
      logits, wanted,
      nn::CrossEntropyFuncOptions().ignore_index(SightBatch::kNotLearned).reduction(torch::kSum));
  return sum / wanted.ge(0).sum().clamp_min(1);
}

torch::Tensor loss_of(SightLayers& layers, const SightBatch& learned, const torch::Tensor& rows) {
  const torch::Tensor kinds = learned.kinds.index_select(0, rows);
  const SightLogits logits = layers->forward(learned.cells.index_select(0, rows).to(torch::kFloat));
  torch::Tensor weights = torch::ones({logits.kinds.size(1)});
  weights[weights.size(0) - 1] = kWeightOfNothing;
  const torch::Tensor seen = nn::cross_entropy(logits.kinds, kinds,
                                               nn::CrossEntropyFuncOptions()
                                                   .weight(weights)
                                                   .ignore_index(SightBatch::kNotLearned)
                                                   .label_smoothing(kSmoothing));
  const torch::Tensor where = at_cells(kinds, learned.where.index_select(0, rows));
  const torch::Tensor colours = at_cells(kinds, learned.colours.index_select(0, rows));
  return seen + kPlaceShare * loss_of_cells(logits.places, where) +
         kColourShare * loss_of_cells(logits.colours, colours);
}

void set_rate(torch::optim::AdamW& optimiser, double rate, int64_t step, double share) {
  const double warm = std::min(1.0, static_cast<double>(step + 1) / kWarmUpSteps);
  const double cool = 0.5 * (1 + std::cos(M_PI * std::min(share, 1.0)));
  for (auto& group : optimiser.param_groups())
    static_cast<torch::optim::AdamWOptions&>(group.options()).lr(rate * warm * cool);
}

double share_of(const torch::Tensor& part, const torch::Tensor& whole) {
  const auto count = whole.sum().item<double>();
  return count > 0 ? part.logical_and(whole).sum().item<double>() / count : 0;
}

}  // namespace

Status fit_sights(SightLayers& layers, const SightBatch& learned, const LearnSightsOptions& options,
                  SightsReport& report, const ProgressSink& progress, const std::stop_token& stop) {
  // A part tells enough of means and deviations.
  const int64_t stride = std::max<int64_t>(1, learned.size() / 2000);
  layers->fit_normaliser(learned.cells.slice(0, 0, learned.size(), stride).to(torch::kFloat));
  torch::optim::AdamW optimiser(
      layers->parameters(),
      torch::optim::AdamWOptions(options.learning_rate).weight_decay(kWeightDecay));
  for (const torch::Tensor& tensor : layers->parameters()) report.parameters += tensor.numel();
  const SteadyTime began = steady_now();
  const double budget = to_seconds(options.budget);
  layers->train();
  for (;; ++report.steps) {
    if (stop.stop_requested()) return cancelled("learning sights was stopped");
    report.seconds = to_seconds(steady_now() - began);
    const double share = report.seconds / budget;
    if (share >= 1) break;
    set_rate(optimiser, options.learning_rate, report.steps, share);
    optimiser.zero_grad();
    const torch::Tensor loss =
        loss_of(layers, learned, torch::randint(learned.size(), {options.batch}, torch::kLong));
    loss.backward();
    optimiser.step();
    const double decay = std::min(1.0 - 1.0 / kLossOver, static_cast<double>(report.steps) /
                                                             static_cast<double>(report.steps + 1));
    report.loss = decay * report.loss + (1 - decay) * loss.item<double>();
    if (progress && report.steps % 16 == 0)
      progress({.what = "learn sights",
                .done = static_cast<uint64_t>(1000 * share),
                .total = 1000,
                .detail = fmt::format("{} steps, loss {:.3f}", report.steps, report.loss)});
  }
  layers->eval();
  return {};
}

void measure_sights(SightLayers& layers, const SightBatch& held_out, SightsReport& report) {
  std::vector<torch::Tensor> sights, places, colours;
  for (int64_t first = 0; first < held_out.size(); first += kMeasuredTogether) {
    const SeenKinds seen = read_kinds(
        layers, held_out.cells.slice(0, first, first + kMeasuredTogether).to(torch::kFloat));
    sights.push_back(seen.sight);
    places.push_back(seen.places.argmax(2));
    colours.push_back(seen.colours.argmax(2));
  }
  const torch::Tensor sight = torch::cat(sights);
  double best = -1;
  for (int i = 0; i < kLimits; ++i) {
    const double limit = 0.05 + 0.9 * i / (kLimits - 1);
    const torch::Tensor told = sight.gt(limit);
    const double found = share_of(told, held_out.sight);
    const double rightly = share_of(held_out.sight, told);
    const double mean = found + rightly > 0 ? 2 * found * rightly / (found + rightly) : 0;
    if (mean <= best) continue;
    best = mean;
    report.min_probability = limit;
    report.found = found;
    report.found_rightly = rightly;
  }
  const torch::Tensor told = sight.gt(report.min_probability).logical_and(held_out.sight);
  report.place_right = share_of(torch::cat(places).eq(held_out.where), told);
  report.colour_right = share_of(torch::cat(colours).eq(held_out.colours), told);
}

}  // namespace engram::speech
