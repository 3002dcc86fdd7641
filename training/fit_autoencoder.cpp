// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>

#include "encoders/weight_rounding.h"
#include "training/fit.h"
#include "training/quality/psnr.h"

namespace engram::training {

using encoders::ImageLatents;
using encoders::Latents;
using torch::Tensor;

namespace {

constexpr double kPeakRate = 1.5e-3;
/// Rate of the backgrounds, relative to the others: their first values are good already.
constexpr double kBackgroundRate = 0.5;
/// Share of the time that rounding is imitated by noise; afterwards latents are rounded.
constexpr double kNoiseShare = 0.5;
/// Share of the time that weights are used as they are; afterwards as they will be stored.
constexpr double kExactShare = 0.75;
constexpr double kLargestGradient = 1.0;
/// Consecutive rows of a batch, after one that is only their past.
constexpr int64_t kChunk = 4;
constexpr double kRecent = 0.02;
/// Elements of an image whose bits count as they are: a larger one's count less, as its error does.
constexpr double kUsualElements = 128 * 128 * 3;

Tensor quantised(const Tensor& z, bool is_noisy) {
  if (is_noisy) return z + torch::rand_like(z) - 0.5;
  return z + (z.round() - z).detach();
}

/// Consecutive rows of a batch.
struct Drawn {
  Tensor rows;               ///< [chunks, kChunk + 1], flat.
  bool is_held_out = false;  ///< They end in parts that the dynamics must not learn from.
};

const Sequence& sequence_of(const Dataset& data, int64_t row) {
  return *std::ranges::find_if(data.sequences,
                               [row](auto& s) { return row < static_cast<int64_t>(s.end); });
}

bool is_held_out(const Dataset& data, int64_t row) {
  return row >= static_cast<int64_t>(held_out_from(sequence_of(data, row)));
}

/// All chunks end in a part of the same kind: the first one decides.
Drawn draw(const Dataset& data, int64_t chunks) {
  const auto any_row = [&] {
    return torch::randint(static_cast<int64_t>(data.size()), {1}, torch::kLong).item<int64_t>();
  };
  std::vector<int64_t> rows;
  Drawn drawn;
  for (int64_t i = 0; i < chunks; ++i) {
    int64_t last = any_row();
    if (i == 0) drawn.is_held_out = is_held_out(data, last);
    while (is_held_out(data, last) != drawn.is_held_out) last = any_row();
    const auto first = static_cast<int64_t>(sequence_of(data, last).first);
    for (int64_t k = kChunk; k >= 0; --k) rows.push_back(std::max(last - k, first));
  }
  drawn.rows = torch::tensor(rows, torch::kLong);
  return drawn;
}

/// Rows `from` to `to` of every chunk of x [chunks * (kChunk + 1), ...], flat.
Tensor of_chunks(const Tensor& x, int64_t from, int64_t to) {
  return x.unflatten(0, {-1, kChunk + 1}).slice(1, from, to).flatten(0, 1);
}

/// The rows before each; the first stands for what was before itself.
Tensor before_each(const Tensor& x) {
  const Tensor rows = x.unflatten(0, {-1, kChunk + 1});
  return torch::cat({rows.slice(1, 0, 1), rows.slice(1, 0, kChunk - 1)}, 1).flatten(0, 1);
}

/// The same part of all tensors of a batch.
template <typename Part>
Latents part_of(const Latents& latents, Part part) {
  Latents result{{}, {}, part(latents.scene)};
  for (const ImageLatents& image : latents.images)
    result.images.push_back({part(image.coarse), part(image.fine)});
  if (latents.numbers.defined()) result.numbers = part(latents.numbers);
  return result;
}

torch::optim::Adam make_optimiser(encoders::DeepModel& model) {
  std::vector<Tensor> backgrounds;
  for (auto& image : model.autoencoder->images) backgrounds.push_back(image->background);
  std::vector<Tensor> rest = model.dynamics->parameters();
  for (const auto& item : model.autoencoder->named_parameters())
    if (!item.key().ends_with("background")) rest.push_back(item.value());
  const auto options = [](double rate) {
    auto adam = std::make_unique<torch::optim::AdamOptions>(rate);
    adam->betas({0.9, 0.98});
    return adam;
  };
  std::vector<torch::optim::OptimizerParamGroup> groups;
  groups.emplace_back(rest, options(kPeakRate));
  groups.emplace_back(backgrounds, options(kPeakRate * kBackgroundRate));
  return torch::optim::Adam(groups, torch::optim::AdamOptions(kPeakRate));
}

void set_rate(torch::optim::Adam& optimiser, double share) {
  const double rate = kPeakRate * learning_rate_share(share);
  auto& groups = optimiser.param_groups();
  static_cast<torch::optim::AdamOptions&>(groups[0].options()).lr(rate);
  static_cast<torch::optim::AdamOptions&>(groups[1].options()).lr(rate * kBackgroundRate);
}

/// What a batch costs.
struct Cost {
  Tensor error;  ///< Mean squared error per row and image, in grey levels. [B, images]
  Tensor bits;   ///< [B]
};

Cost cost_of(encoders::DeepModel& model, const encoders::Parts& values, bool is_noisy) {
  Latents all = model.autoencoder->encode(values);
  for (ImageLatents& image : all.images)
    image = {quantised(image.coarse, is_noisy), quantised(image.fine, is_noisy)};
  const auto now_part = [](const Tensor& x) { return of_chunks(x, 1, kChunk + 1); };
  const Latents now = part_of(all, now_part);
  const Latents last = part_of(all, [](const Tensor& x) { return of_chunks(x, 0, kChunk); });
  const Latents before = part_of(all, before_each);
  Cost cost;
  cost.bits = model.dynamics->bits(now, last, before);
  const encoders::Parts decoded = model.autoencoder->decode(now);
  std::vector<Tensor> errors;
  for (size_t i = 0; i < values.images.size(); ++i)
    errors.push_back((decoded.images[i] - now_part(values.images[i])).square().mean({1, 2, 3}));
  cost.error = torch::stack(errors, 1);
  return cost;
}

double mean_psnr_db(const Tensor& error) {
  const Tensor psnr = 10.0 * torch::log10(255.0 * 255.0 / error.detach().clamp_min(1e-3));
  return psnr.mean().item<double>();
}

/// Elements of all images of a value, in usual images.
double size_of(const encoders::NetworkShape& shape) {
  double elements = 0;
  for (const auto& image : shape.images)
    elements += static_cast<double>(image.channels) * image.height * image.width;
  return elements / kUsualElements;
}

void start_from_backgrounds(encoders::DeepModel& model, const Dataset& data) {
  torch::NoGradGuard no_grad;
  for (size_t i = 0; i < data.backgrounds.size(); ++i)
    model.autoencoder->images[i]->background.copy_(data.backgrounds[i] / encoders::kGreyLevels);
}

}  // namespace

Result<FitStep> fit_autoencoder(encoders::DeepModel& model, const Dataset& data,
                                const TrainOptions& options, const Schedule& schedule,
                                const std::stop_token& stop, const StepSink& sink) {
  FitStep now;
  if (model.autoencoder->images.empty()) return now;
  start_from_backgrounds(model, data);
  auto optimiser = make_optimiser(model);
  std::vector<Tensor> parameters = optimiser.param_groups()[0].params();
  const int64_t chunks = std::max<int64_t>(1, options.batch_size / kChunk);
  const double size = size_of(model.autoencoder->shape);
  ErrorPrice price(options.psnr_db);
  Smoothed loss_mean(kRecent), psnr(kRecent), bytes(kRecent);
  for (double share = 0; (share = schedule.share(now.step)) < 1.0; ++now.step) {
    if (stop.stop_requested()) return cancelled("training was stopped");
    set_rate(optimiser, share);
    const Drawn drawn = draw(data, chunks);
    const auto values = data.batch(model.autoencoder->shape, drawn.rows);
    // What predictions are measured on must not teach the prior: it only tells what latents cost.
    std::optional<Frozen> frozen;
    if (drawn.is_held_out) frozen.emplace(*model.dynamics);
    std::optional<encoders::RoundedWeights> rounded;
    if (share >= kExactShare) rounded.emplace(*model.autoencoder);
    const Cost cost = cost_of(model, values, share < kNoiseShare);
    const Tensor loss = cost.error.mean() * price.value() + cost.bits.mean() / (8000.0 * size);
    optimiser.zero_grad();
    loss.backward();
    if (rounded) rounded->restore();
    torch::nn::utils::clip_grad_norm_(parameters, kLargestGradient);
    optimiser.step();
    loss_mean.add(loss.item<double>());
    psnr.add(mean_psnr_db(cost.error));
    bytes.add(cost.bits.detach().mean().item<double>() / 8);
    price.follow(psnr.value(), share);
    now.loss = loss_mean.value();
    now.psnr_db = psnr.value();
    now.bytes = bytes.value();
    sink(now);
  }
  return now;
}

}  // namespace engram::training
