// SPDX-License-Identifier: Apache-2.0
#include "training/forms/latent_refinement.h"

#include <cmath>
#include <numbers>

#include "training/fit/gradients.h"
#include "training/fit/image_units.h"
#include "training/fit/schedule.h"
#include "training/quality/quality_metrics.h"

namespace engram::training {

using encoders::DeepModel;
using encoders::ImageLatents;
using encoders::LatentRows;
using encoders::Latents;
using encoders::Parts;
using torch::Tensor;

namespace {

/// Learning rate at the start. It bounds the move of a latent in one step of the optimiser, in
/// steps of the quantiser.
constexpr double kPeakRate = 0.1;
/// Speed at which the price of a row rises below the bound and falls above it, per decibel and
/// step.
constexpr double kSteering = 0.03;
/// Target above the bound at which prices stay constant. Unit: dB.
constexpr double kAbove = 0.05;

Tensor rounded_through(const Tensor& z) {
  return z + (z.round() - z).detach();
}

/// The predecessor of each row. The first row has none.
Tensor before_each(const Tensor& z) {
  return torch::cat({z.slice(0, 0, 1).detach(), z.slice(0, 0, z.size(0) - 1)});
}

Latents before_each(const Latents& z) {
  Latents before{{}, {}, z.scene};
  for (const ImageLatents& image : z.images)
    before.images.push_back({before_each(image.coarse), before_each(image.fine)});
  if (z.numbers.defined()) before.numbers = before_each(z.numbers);
  return before;
}

/// Approximate bits of a first row, with a Laplace distribution around zero for each channel.
Tensor bits_alone(const Tensor& row) {
  const Tensor scale = row.detach().abs().mean({0, 2, 3}, true).clamp_min(0.05);
  return encoders::laplace_bits(row.abs(), scale).sum();
}

/// Refines the latents of one block.
class Refinement {
 public:
  Refinement(DeepModel& model, std::span<const idf::SplitValue> values, LatentRows rows,
             const RefineOptions& options)
      : model_(model), values_(values), options_(options), best_(std::move(rows)) {}

  Result<LatentRows> run(const std::stop_token& stop) {
    ENGRAM_RETURN_IF_ERROR(load());
    const FrozenParameters autoencoder(*model_.autoencoder);
    const FrozenParameters dynamics(*model_.dynamics);
    ENGRAM_ASSIGN_OR_RETURN(best_cost_, real_cost(best_));
    torch::optim::Adam optimiser(leaves_, torch::optim::AdamOptions(kPeakRate));
    for (int step = 0; step < options_.steps; ++step) {
      if (stop.stop_requested()) return cancelled("refinement of latents was stopped");
      const double share = static_cast<double>(step) / options_.steps;
      auto& group = optimiser.param_groups()[0].options();
      static_cast<torch::optim::AdamOptions&>(group).lr(kPeakRate * 0.5 *
                                                        (1 + std::cos(std::numbers::pi * share)));
      forget_gradients(optimiser);
      cost().backward();
      optimiser.step();
    }
    ENGRAM_RETURN_IF_ERROR(keep_if_better());
    return std::move(best_);
  }

 private:
  Status load() {
    std::vector<Parts> all;
    for (const idf::SplitValue& value : values_) {
      ENGRAM_ASSIGN_OR_RETURN(all.emplace_back(), model_.to_parts(value));
    }
    const auto count = static_cast<int64_t>(all.size());
    scene_ = torch::full({count}, static_cast<int64_t>(best_.scene), torch::kLong);
    for (size_t i = 0; i < all.front().images.size(); ++i) {
      std::vector<Tensor> images;
      for (const Parts& one : all) images.push_back(one.images[i]);
      truth_.images.push_back(torch::cat(images));
    }
    if (all.front().numbers.defined()) {
      std::vector<Tensor> numbers;
      for (const Parts& one : all) numbers.push_back(one.numbers);
      truth_.numbers = torch::cat(numbers);
    }
    truth_.scene = scene_;
    truth_.backgrounds = model_.backgrounds_of(best_);
    torch::NoGradGuard no_grad;
    views_ = model_.autoencoder->views_of(scene_, truth_.backgrounds);
    size_ = size_in_usual_images(model_.autoencoder->shape);
    prices_ = torch::full({count}, price());
    start();
    return {};
  }

  void start() {
    torch::NoGradGuard no_grad;
    for (const ImageLatents& image : model_.autoencoder->encode(truth_, views_).images)
      for (const Tensor& z : {image.coarse, image.fine})
        leaves_.push_back(z.detach().clone().set_requires_grad(true));
  }

  [[nodiscard]] Latents rounded() const {
    Latents z{{}, truth_.numbers, scene_};
    for (size_t i = 0; i < leaves_.size(); i += 2)
      z.images.push_back({rounded_through(leaves_[i]), rounded_through(leaves_[i + 1])});
    return z;
  }

  Tensor cost() {
    const Latents now = rounded();
    const Latents last = before_each(now);
    const Tensor after_first =
        model_.dynamics->bits(now, last, before_each(last)).slice(0, 1).sum();
    Tensor first = torch::zeros({});
    for (const ImageLatents& image : now.images)
      first =
          first + bits_alone(image.coarse.slice(0, 0, 1)) + bits_alone(image.fine.slice(0, 0, 1));
    const Tensor error = errors(now);
    const Tensor paid = (error.mean(1) * prices_).sum();
    if (options_.bound_db > 0) steer(std::get<0>(error.detach().max(1)));
    return paid + (first + after_first) / (kBitsOfKilobyte * size_);
  }

  /// Mean squared error per row and image. Shape: [B, images].
  Tensor errors(const Latents& z) {
    const Parts decoded = model_.autoencoder->decode(z, views_);
    std::vector<Tensor> errors;
    for (size_t i = 0; i < decoded.images.size(); ++i)
      errors.push_back((decoded.images[i] - truth_.images[i]).square().mean({1, 2, 3}));
    return torch::stack(errors, 1);
  }

  /// Price at the end of the model's training. Unit: kilobytes per squared grey level.
  [[nodiscard]] double price() const {
    const double known = model_.provenance.error_price;
    return known > 0 ? known : encoders::kUsualPrice;
  }

  /// Adapts the prices. `error` is that of the worst image of each row.
  void steer(const Tensor& error) {
    const Tensor psnr = 10.0 * torch::log10(255.0 * 255.0 / error.clamp_min(1e-3));
    const Tensor below = (options_.bound_db + kAbove - psnr).clamp(-3.0, 3.0);
    prices_ = prices_ * torch::exp(kSteering * below);
  }

  /// The cost of rows as they will be stored.
  struct Cost {
    size_t below_bound = 0;
    double value = 0;
    [[nodiscard]] bool is_less_than(const Cost& other) const {
      if (below_bound != other.below_bound) return below_bound < other.below_bound;
      return value < other.value;
    }
  };

  Result<Cost> real_cost(const LatentRows& rows) {
    Cost cost;
    for (size_t i = 0; i < rows.images.size(); ++i)
      cost.value +=
          static_cast<double>(model_.codec.chain.images[i].encode(rows.images[i].latents).size()) /
          (1000.0 * size_);
    // With a bound, a lower error than the bound has no value.
    const double paid = options_.bound_db > 0 ? 0 : price();
    for (size_t row = 0; row < values_.size(); ++row) {
      ENGRAM_ASSIGN_OR_RETURN(const auto images, model_.decode_images(rows, row));
      double error = 0;
      bool is_below = false;
      for (size_t i = 0; i < images.size(); ++i) {
        const auto& member = model_.plan.images()[i];
        ENGRAM_ASSIGN_OR_RETURN(const double mse,
                                grey_mse(values_[row].tensors[member.member], images[i]));
        error += mse / static_cast<double>(images.size());
        // Only lossless forms keep depth, so latents of depth do not count here.
        is_below = is_below || (!member.is_depth && psnr_db(mse) < options_.bound_db);
      }
      cost.below_bound += is_below ? 1 : 0;
      cost.value += paid * error;
    }
    return cost;
  }

  Status keep_if_better() {
    torch::NoGradGuard no_grad;
    LatentRows rows = best_;
    const Latents z = rounded();
    for (size_t i = 0; i < z.images.size(); ++i) {
      rows.images[i].latents.clear();
      for (int64_t row = 0; row < scene_.size(0); ++row) {
        const auto one = DeepModel::to_integers(
            {z.images[i].coarse.slice(0, row, row + 1), z.images[i].fine.slice(0, row, row + 1)});
        rows.images[i].latents.insert(rows.images[i].latents.end(), one.begin(), one.end());
      }
    }
    ENGRAM_ASSIGN_OR_RETURN(const Cost cost, real_cost(rows));
    if (cost.is_less_than(best_cost_)) best_ = std::move(rows);
    return {};
  }

  DeepModel& model_;
  std::span<const idf::SplitValue> values_;
  const RefineOptions& options_;
  LatentRows best_;
  Cost best_cost_;
  Parts truth_;
  Tensor scene_, prices_;
  encoders::Views views_;
  double size_ = 1;
  std::vector<Tensor> leaves_;  ///< Coarse and fine latents of each image in turn.
};

}  // namespace

Result<LatentRows> refine_latents(DeepModel& model, std::span<const idf::SplitValue> values,
                                  LatentRows rows, const RefineOptions& options,
                                  const std::stop_token& stop) {
  if (options.steps <= 0 || model.autoencoder->images.empty()) return rows;
  return Refinement(model, values, std::move(rows), options).run(stop);
}

}  // namespace engram::training
