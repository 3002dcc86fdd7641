// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "training/fit.h"

namespace engram::training {

using torch::Tensor;

namespace {

constexpr double kPeakRate = 1.5e-3;
/// Rate of the linear parts, relative to the others: their first values are good already.
constexpr double kLinearRate = 0.1;
/// Share of the time that rounding is imitated by noise; afterwards latents are rounded.
constexpr double kNoiseShare = 0.3;
constexpr double kLargestGradient = 1.0;
constexpr int64_t kMostInitialImages = 512;
/// Pixels farther than this from the background count as moving. Unit: grey levels.
constexpr double kMoving = 12.0;

/// Squared error at which one more bit is worth its price (uniform quantiser, high rate).
double mse_of(double lambda) {
  return 1.0 / (2.0 * std::numbers::ln2 * lambda);
}

/// Price of a squared normalised number that leads to this error.
double number_lambda(double error) {
  return 1.0 / (2.0 * std::numbers::ln2 * error * error);
}

Tensor quantised(const Tensor& z, bool is_noisy) {
  if (is_noisy) return z + torch::rand_like(z) - 0.5;
  return z + (z.round() - z).detach();
}

encoders::Parts quantised(const encoders::Parts& latents, bool is_noisy) {
  encoders::Parts result;
  for (const Tensor& image : latents.images) result.images.push_back(quantised(image, is_noisy));
  if (latents.numbers.defined()) result.numbers = quantised(latents.numbers, is_noisy);
  return result;
}

void initialise(encoders::DeepModel& model, const Dataset& data, const TrainOptions& options) {
  const int64_t rows = static_cast<int64_t>(data.size());
  const int64_t stride = std::max<int64_t>(1, rows / kMostInitialImages);
  const auto sample =
      data.batch(model.autoencoder->shape, torch::arange(0, rows, stride, torch::kLong));
  for (size_t i = 0; i < sample.images.size(); ++i)
    model.autoencoder->images[i]->initialise(sample.images[i], mse_of(options.lambda));
  if (data.numbers.defined())
    model.autoencoder->numbers->initialise(data.numbers,
                                           options.number_error * options.number_error);
}

/// Squared error per pixel and channel, moving pixels weighted.
Tensor image_error(const Tensor& x, const Tensor& decoded, const Tensor& background,
                   double weight) {
  const Tensor error = (x - decoded).square();
  if (weight == 1.0) return error.mean();
  const Tensor moving =
      ((x - background.detach() * encoders::kGreyLevels).abs().amax(1, true) > kMoving);
  const Tensor weights = 1.0 + (weight - 1.0) * moving.to(torch::kFloat32);  // [B, 1, H, W]
  return (error * weights).mean() / weights.mean();
}

Tensor loss_of(encoders::DeepModel& model, const encoders::Parts& values,
               const TrainOptions& options, bool is_noisy) {
  auto& autoencoder = model.autoencoder;
  const auto latents = quantised(autoencoder->encode(values), is_noisy);
  const auto decoded = autoencoder->decode(latents);
  Tensor loss = torch::zeros({});
  for (size_t i = 0; i < values.images.size(); ++i) {
    const Tensor& x = values.images[i];
    const double elements = static_cast<double>(x.numel());
    loss = loss + autoencoder->images[i]->bits(latents.images[i]).sum() / elements +
           options.lambda * image_error(x, decoded.images[i], autoencoder->images[i]->background,
                                        options.moving_weight);
  }
  if (values.numbers.defined()) {
    const Tensor error = (values.numbers - decoded.numbers).square().mean();
    const double elements = static_cast<double>(values.numbers.numel());
    loss = loss + number_lambda(options.number_error) * error +
           autoencoder->numbers->bits(latents.numbers).sum() / elements;
  }
  return loss;
}

/// Two groups: the linear parts first, the rest second.
torch::optim::Adam make_optimiser(encoders::Autoencoder& autoencoder) {
  std::vector<Tensor> linear;
  for (auto& image : autoencoder->images)
    for (const Tensor& tensor : image->linear_parameters()) linear.push_back(tensor);
  if (autoencoder->numbers)
    for (const Tensor& tensor : autoencoder->numbers->linear_parameters()) linear.push_back(tensor);
  std::vector<Tensor> rest;
  for (const Tensor& tensor : autoencoder->parameters())
    if (std::none_of(linear.begin(), linear.end(),
                     [&](const Tensor& t) { return t.is_same(tensor); }))
      rest.push_back(tensor);
  std::vector<torch::optim::OptimizerParamGroup> groups;
  groups.emplace_back(linear, std::make_unique<torch::optim::AdamOptions>(kPeakRate * kLinearRate));
  groups.emplace_back(rest, std::make_unique<torch::optim::AdamOptions>(kPeakRate));
  return torch::optim::Adam(groups, torch::optim::AdamOptions(kPeakRate));
}

void set_rate(torch::optim::Adam& optimiser, double share) {
  const double rate = kPeakRate * learning_rate_share(share);
  auto& groups = optimiser.param_groups();
  static_cast<torch::optim::AdamOptions&>(groups[0].options()).lr(rate * kLinearRate);
  static_cast<torch::optim::AdamOptions&>(groups[1].options()).lr(rate);
}

}  // namespace

Schedule::Schedule(std::optional<int> steps, double seconds)
    : steps_(steps), seconds_(seconds), start_(std::chrono::steady_clock::now()) {}

double Schedule::share(int64_t step) const {
  if (steps_) return static_cast<double>(step) / std::max(*steps_, 1);
  return to_seconds(std::chrono::steady_clock::now() - start_) / seconds_;
}

double Schedule::seconds_left(int64_t step) const {
  const double elapsed = to_seconds(std::chrono::steady_clock::now() - start_);
  if (!steps_) return std::max(seconds_ - elapsed, 0.0);
  return step == 0 ? -1 : elapsed / static_cast<double>(step) * static_cast<double>(*steps_ - step);
}

double learning_rate_share(double share) {
  constexpr double kWarmUp = 0.03;
  constexpr double kLast = 0.01;
  if (share < kWarmUp) return kLast + (1 - kLast) * share / kWarmUp;
  const double rest = std::min((share - kWarmUp) / (1 - kWarmUp), 1.0);
  return kLast + (1 - kLast) * 0.5 * (1 + std::cos(std::numbers::pi * rest));
}

Result<FitResult> fit_autoencoder(encoders::DeepModel& model, const Dataset& data,
                                  const TrainOptions& options, const Schedule& schedule,
                                  const std::stop_token& stop, const StepSink& sink) {
  initialise(model, data, options);
  auto optimiser = make_optimiser(model.autoencoder);
  const auto rows = static_cast<int64_t>(data.size());
  FitResult result;
  Tensor order;
  int64_t at = rows;
  for (double share = 0; (share = schedule.share(result.steps)) < 1.0; ++result.steps) {
    if (stop.stop_requested()) return cancelled("training was stopped");
    if (at + std::min<int64_t>(options.batch_size, rows) > rows) {
      order = torch::randperm(rows, torch::kLong);
      at = 0;
    }
    const Tensor indices = order.slice(0, at, at + options.batch_size);
    at += options.batch_size;
    set_rate(optimiser, share);
    optimiser.zero_grad();
    const Tensor loss =
        loss_of(model, data.batch(model.autoencoder->shape, indices), options, share < kNoiseShare);
    loss.backward();
    torch::nn::utils::clip_grad_norm_(model.autoencoder->parameters(), kLargestGradient);
    optimiser.step();
    const auto value = loss.item<double>();
    result.loss = result.steps == 0 ? value : 0.95 * result.loss + 0.05 * value;
    sink(result.steps, result.loss, schedule.seconds_left(result.steps));
  }
  return result;
}

std::vector<int32_t> latents_of(encoders::DeepModel& model, const Dataset& data, size_t row) {
  torch::NoGradGuard no_grad;
  const Tensor index = torch::tensor({static_cast<int64_t>(row)}, torch::kLong);
  const auto values = data.batch(model.autoencoder->shape, index);
  return model.to_integers(encoders::round(model.autoencoder->encode(values)));
}

}  // namespace engram::training
