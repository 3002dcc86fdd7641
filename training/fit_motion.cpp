// SPDX-License-Identifier: Apache-2.0
#include "training/fit.h"

namespace engram::training {

using encoders::ImageMotionImpl;
using torch::Tensor;

namespace {

constexpr double kPeakRate = 1e-3;
constexpr double kWeightDecay = 1e-2;
constexpr double kLargestGradient = 1.0;
/// Most that images are shifted by, relative to their side.
constexpr double kMostShift = 0.08;
/// Most that contrast and brightness are changed by: a factor, and grey levels.
constexpr double kMostContrast = 0.15;
constexpr double kMostBrightness = 12.0;
/// Errors below are all alike. Unit: squared grey levels.
constexpr double kLeastError = 4.0;
constexpr double kRecent = 0.05;
/// Share of the batches whose conditions are not known.
constexpr double kUnknownShare = 0.2;
/// What conditions are blurred by, in standard deviations, and their changes relative to that.
constexpr double kConditionBlur = 0.1;
constexpr double kChangeBlur = 0.3;

double uniform(double most) {
  return (torch::rand({1}, torch::kFloat64).item<double>() * 2 - 1) * most;
}

/// Another view of the same movement: shifted, repeating the edge, in other light. Shape: the
/// images of one window [kSteps + 2, C, H, W].
Tensor varied(const Tensor& images) {
  namespace F = torch::nn::functional;
  const auto most = [&](int dim) {
    return static_cast<int64_t>(kMostShift * static_cast<double>(images.size(dim)));
  };
  const auto pad = std::max<int64_t>(1, std::max(most(2), most(3)));
  const Tensor wide =
      F::pad(images, F::PadFuncOptions({pad, pad, pad, pad}).mode(torch::kReplicate));
  const auto down = pad + static_cast<int64_t>(uniform(static_cast<double>(most(2))));
  const auto right = pad + static_cast<int64_t>(uniform(static_cast<double>(most(3))));
  const Tensor shifted =
      wide.slice(2, down, down + images.size(2)).slice(3, right, right + images.size(3));
  return shifted * (1 + uniform(kMostContrast)) + uniform(kMostBrightness);
}

/// Windows of one image member, each seen differently: per step [B, C, H, W].
std::vector<Tensor> draw(const Dataset& data, const encoders::NetworkShape& shape, size_t image,
                         const Tensor& rows) {
  std::vector<Tensor> steps;
  for (int64_t step = -1; step <= ImageMotionImpl::kSteps; ++step)
    steps.push_back(data.batch(shape, rows + step).images[image]);
  const Tensor windows = torch::stack(steps, 1);
  std::vector<Tensor> seen;
  for (int64_t i = 0; i < windows.size(0); ++i) seen.push_back(varied(windows[i]));
  return torch::stack(seen).unbind(1);
}

/// Mean logarithm of the squared error, so that a decibel counts the same in every image.
Tensor loss_of(encoders::ImageMotion& motion, const std::vector<Tensor>& window,
               const Tensor& features) {
  const auto predicted = motion(window[1].contiguous(at::MemoryFormat::ChannelsLast),
                                window[0].contiguous(at::MemoryFormat::ChannelsLast), features);
  Tensor loss = torch::zeros({});
  for (size_t step = 0; step < predicted.size(); ++step)
    loss =
        loss +
        ((predicted[step] - window[2 + step]).square().mean({1, 2, 3}) + kLeastError).log().mean();
  return loss;
}

/// What motion is told of some rows. Conditions are blurred, and unknown in some batches: what was
/// seen of them is little.
Tensor features_of(encoders::DeepModel& model, const Dataset& data, const Tensor& rows) {
  const auto part_of = [&](const Tensor& at) {
    encoders::Parts parts;
    parts.scene = data.scene.index_select(0, at);
    if (data.numbers.defined()) parts.numbers = data.numbers.index_select(0, at);
    return parts;
  };
  encoders::Parts last = part_of(rows);
  encoders::Parts before = part_of(rows - 1);
  const bool is_known = torch::rand({1}).item<double>() >= kUnknownShare;
  if (data.conditions.defined() && is_known) {
    last.conditions = data.conditions.index_select(0, rows);
    before.conditions = data.conditions.index_select(0, rows - 1);
    const Tensor blur = torch::randn_like(last.conditions) * kConditionBlur;
    last.conditions = last.conditions + blur;
    before.conditions =
        before.conditions + blur + torch::randn_like(blur) * (kConditionBlur * kChangeBlur);
  }
  return model.dynamics->motion_features(last, before);
}

/// Pulls weights towards zero, apart from their gradients.
void decay(const std::vector<Tensor>& parameters, double rate) {
  torch::NoGradGuard no_grad;
  for (Tensor parameter : parameters) parameter.mul_(1 - rate * kWeightDecay);
}

}  // namespace

Result<FitStep> fit_motion(encoders::DeepModel& model, const Dataset& data,
                           const TrainOptions& options, FitLoop& loop) {
  FitStep result;
  Smoothed loss_mean(kRecent);
  const auto rows = make_windows(data.sequences, ImageMotionImpl::kSteps).training;
  auto& images = model.dynamics->images;
  if (rows.empty() || images.empty()) return result;
  std::vector<Tensor> parameters;
  for (const auto& item : model.dynamics->named_parameters())
    if (item.key().find("motion") != std::string::npos || item.key().starts_with("condition"))
      parameters.push_back(item.value());
  torch::optim::Adam optimiser(parameters, torch::optim::AdamOptions(kPeakRate));
  const Tensor windows = torch::tensor(rows, torch::kLong);
  FitState state{model, optimiser, result, loss_mean.state()};
  ENGRAM_RETURN_IF_ERROR(loop.begin(state));
  for (;; ++result.step) {
    ENGRAM_ASSIGN_OR_RETURN(const double share, loop.next(state));
    if (share >= 1.0) break;
    const double rate = kPeakRate * learning_rate_share(share);
    auto& group = optimiser.param_groups()[0].options();
    static_cast<torch::optim::AdamOptions&>(group).lr(rate);
    const Tensor now = windows.index_select(
        0, torch::randint(windows.size(0), {options.batch_size}, torch::kLong));
    const Tensor features = features_of(model, data, now);
    optimiser.zero_grad();
    Tensor loss = torch::zeros({});
    for (size_t i = 0; i < images.size(); ++i)
      loss =
          loss + loss_of(images[i]->motion, draw(data, model.autoencoder->shape, i, now), features);
    loss.backward();
    torch::nn::utils::clip_grad_norm_(parameters, kLargestGradient);
    optimiser.step();
    decay(parameters, rate);
    loss_mean.add(loss.item<double>());
    result.loss = loss_mean.value();
    loop.tell(result);
  }
  return result;
}

}  // namespace engram::training
