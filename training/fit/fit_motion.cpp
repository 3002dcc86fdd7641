// SPDX-License-Identifier: Apache-2.0
#include "training/fit/fit_motion.h"

#include <algorithm>

#include "encoders/moved_images.h"
#include "training/fit/gradients.h"
#include "training/fit/view_change.h"
#include "training/fit/windows.h"

namespace engram::training {

using encoders::ImageMotionImpl;
using torch::Tensor;

namespace {

constexpr double kMotionRate = 1e-3;
constexpr double kWeightDecay = 1e-2;
constexpr double kMaxMotionGradient = 1.0;
/// Min error in the loss: smaller errors count as equal. Unit: squared grey levels.
constexpr double kMinError = 4.0;
constexpr double kRecentShare = 0.05;
/// Training ends after kMaxPasses passes over the windows, but not before kFewestSteps steps: more
/// passes memorise recordings and were worse on left-out ones. Chosen on the same five recordings
/// as kMinGainOfLatents.
constexpr int64_t kMaxPasses = 5;
constexpr int64_t kFewestSteps = 400;
/// Share of the batches without conditions.
constexpr double kUnknownShare = 0.2;
/// Share of the other batches that get the following numbers as a plan.
constexpr double kPlannedShare = 0.35;
/// Noise that is added to conditions, in standard deviations, and to their changes, relative to
/// that.
constexpr double kConditionBlur = 0.1;
constexpr double kChangeBlur = 0.3;

/// The images of one image member extrapolated by optical flow. They are computed on first use.
class MovedImages {
 public:
  MovedImages(const Dataset& data, const encoders::NetworkShape& shape, size_t image)
      : data_(data), shape_(shape), image_(image), known_(data.size()) {}

  /// Shape: rows [B] -> [B, kSteps, C, H, W].
  Tensor of(const Tensor& rows) {
    std::vector<Tensor> all;
    for (int64_t i = 0; i < rows.size(0); ++i) {
      const Tensor row = rows.slice(0, i, i + 1);
      Tensor& known = known_[static_cast<size_t>(row.item<int64_t>())];
      all.push_back(known.defined() ? known : found(row));
      if (known.defined() || bytes_ + all.back().numel() > kMaxKnownBytes) continue;
      known = all.back();
      bytes_ += known.numel();
    }
    return torch::cat(all).to(torch::kFloat32);
  }

 private:
  static constexpr int64_t kMaxKnownBytes = int64_t{1} << 30;

  [[nodiscard]] Tensor found(const Tensor& row) const {
    return encoders::moved_on(data_.batch(shape_, row - 1).images[image_],
                              data_.batch(shape_, row).images[image_], ImageMotionImpl::kSteps)
        .to(torch::kUInt8);
  }

  const Dataset& data_;
  const encoders::NetworkShape& shape_;
  size_t image_;
  std::vector<Tensor> known_;  ///< Per row, up to a limit of memory.
  int64_t bytes_ = 0;          ///< Bytes in `known_`.
};

/// Windows of one image member, each with its own change of view: the image before, the last one,
/// those to predict, and those extrapolated by flow. Shape: [B, C, H, W].
std::vector<Tensor> draw(const Dataset& data, const encoders::NetworkShape& shape, size_t image,
                         MovedImages& moved, const Tensor& rows) {
  std::vector<Tensor> steps;
  for (int64_t step = -1; step <= ImageMotionImpl::kSteps; ++step)
    steps.push_back(data.batch(shape, rows + step).images[image]);
  const Tensor windows = torch::cat({torch::stack(steps, 1), moved.of(rows)}, 1);
  std::vector<Tensor> seen;
  for (int64_t i = 0; i < windows.size(0); ++i)
    seen.push_back(ViewChange::draw(false).of(windows[i]));
  return torch::stack(seen).unbind(1);
}

/// Mean logarithm of the squared error, so that a decibel has the same weight in every image.
Tensor loss_of(encoders::ImageMotion& motion, const std::vector<Tensor>& window,
               const Tensor& features) {
  const Tensor moved = torch::stack(
      std::vector<Tensor>(window.begin() + 2 + ImageMotionImpl::kSteps, window.end()), 1);
  const auto predicted =
      motion(window[1].contiguous(at::MemoryFormat::ChannelsLast),
             window[0].contiguous(at::MemoryFormat::ChannelsLast), moved, features);
  Tensor loss = torch::zeros({});
  for (size_t step = 0; step < predicted.size(); ++step)
    loss = loss +
           ((predicted[step] - window[2 + step]).square().mean({1, 2, 3}) + kMinError).log().mean();
  return loss;
}

/// The features of motion for some rows. Conditions get noise and are missing in some batches,
/// because the training data covers few of their values.
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
    if (torch::rand({1}).item<double>() < kPlannedShare) {
      std::vector<Tensor> planned;
      for (int64_t step = 1; step <= ImageMotionImpl::kSteps; ++step)
        planned.push_back(data.conditions.index_select(0, rows + step) + blur +
                          torch::randn_like(blur) * (kConditionBlur * kChangeBlur));
      last.plan = torch::stack(planned, 1);
    }
  }
  return model.dynamics->motion_features(last, before);
}

/// Decays weights towards zero, independently of their gradients.
void decay(const std::vector<Tensor>& parameters, double rate) {
  torch::NoGradGuard no_grad;
  for (Tensor parameter : parameters) parameter.mul_(1 - rate * kWeightDecay);
}

}  // namespace

Result<FitStep> fit_motion(encoders::DeepModel& model, const Dataset& data,
                           const TrainOptions& options, FitLoop& loop) {
  FitStep result;
  Smoothed loss_mean(kRecentShare);
  const auto rows =
      make_windows(data.sequences, data.first_held_out, ImageMotionImpl::kSteps).training;
  auto& images = model.dynamics->images;
  if (rows.empty() || images.empty()) return result;
  std::vector<Tensor> parameters;
  for (const auto& item : model.dynamics->named_parameters())
    if (item.key().find("motion") != std::string::npos || item.key().starts_with("condition"))
      parameters.push_back(item.value());
  torch::optim::Adam optimiser(parameters, torch::optim::AdamOptions(kMotionRate));
  const Tensor windows = torch::tensor(rows, torch::kLong);
  const int64_t max_steps =
      std::max(kFewestSteps, kMaxPasses * windows.size(0) / int64_t{options.batch_size});
  const auto& shape = model.autoencoder->shape;
  std::vector<MovedImages> moved;
  for (size_t i = 0; i < images.size(); ++i) moved.emplace_back(data, shape, i);
  FitState state{model, optimiser, result, loss_mean.state()};
  ENGRAM_RETURN_IF_ERROR(loop.begin(state));
  for (;; ++result.step) {
    ENGRAM_ASSIGN_OR_RETURN(double share, loop.next(state));
    share = std::max(share, static_cast<double>(result.step) / static_cast<double>(max_steps));
    if (share >= 1.0) break;
    const double rate = kMotionRate * learning_rate_share(share);
    auto& group = optimiser.param_groups()[0].options();
    static_cast<torch::optim::AdamOptions&>(group).lr(rate);
    const Tensor now = windows.index_select(
        0, torch::randint(windows.size(0), {options.batch_size}, torch::kLong));
    const Tensor features = features_of(model, data, now);
    forget_gradients(optimiser);
    Tensor loss = torch::zeros({});
    for (size_t i = 0; i < images.size(); ++i)
      loss = loss + loss_of(images[i]->motion, draw(data, shape, i, moved[i], now), features);
    loss.backward();
    torch::nn::utils::clip_grad_norm_(parameters, kMaxMotionGradient);
    optimiser.step();
    decay(parameters, rate);
    loss_mean.add(loss.item<double>());
    result.loss = loss_mean.value();
    loop.tell(result);
  }
  return result;
}

}  // namespace engram::training
