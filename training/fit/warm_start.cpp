// SPDX-License-Identifier: Apache-2.0
#include "training/fit/warm_start.h"

#include "encoders/deep_model_file.h"
#include "training/fit/network_width.h"

namespace engram::training {

using torch::Tensor;

namespace {

/// The reason why networks for `snapshots` snapshots cannot start from a model; empty if they can.
std::string misfit(const encoders::DeepModel& model, size_t snapshots,
                   const TrainOptions& options) {
  const encoders::NetworkSizes& found = model.autoencoder->shape.sizes;
  if (model.provenance.variant != options.variant)
    return fmt::format("it is of variant {}, not {}", to_string(model.provenance.variant),
                       to_string(options.variant));
  if (model.plan.images().empty() || !options.has_networks) return {};
  if (const int width = network_width(options, snapshots); found.width != width)
    return fmt::format("it has {} features, what there is to save by now asks for {}", found.width,
                       width);
  if (found.coarse_channels != options.coarse_channels ||
      found.fine_channels != options.fine_channels)
    return fmt::format("it has {} and {} latent channels, not {} and {}", found.coarse_channels,
                       found.fine_channels, options.coarse_channels, options.fine_channels);
  return {};
}

/// Whether tensors differ only in their number of backgrounds.
bool has_more_scenes(const Tensor& from, const Tensor& to, int64_t from_scenes, int64_t to_scenes) {
  return from.dim() == to.dim() && from.dim() > 1 && from.size(0) == from_scenes &&
         to.size(0) == to_scenes && from_scenes < to_scenes &&
         from.sizes().slice(1) == to.sizes().slice(1);
}

void copy_parameters(const torch::nn::Module& from, torch::nn::Module& to, int64_t from_scenes,
                     int64_t to_scenes) {
  const auto known = from.named_parameters();
  for (auto& item : to.named_parameters()) {
    const Tensor* found = known.find(item.key());
    if (found == nullptr) continue;
    Tensor& weights = item.value();
    if (found->sizes() == weights.sizes()) {
      weights.copy_(*found);
    } else if (has_more_scenes(*found, weights, from_scenes, to_scenes)) {
      weights.slice(0, 0, from_scenes).copy_(*found);
      weights.slice(0, from_scenes).copy_(found->mean(0, true));
    }
  }
}

}  // namespace

Result<WarmStart> find_start(const TrainingSource& source, const TrainOptions& options) {
  if (!source.previous) return WarmStart{};
  const std::string name = fmt::format("v{}", source.previous->version);
  const auto anew = [&](const std::string& why) {
    return WarmStart{nullptr, fmt::format("training started anew, not from {}: {}", name, why)};
  };
  auto model = encoders::read_model(source.previous->file);
  if (!model.ok()) return anew(model.status().message());
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data newest, source.read(source.times.size() - 1));
  const idf::Layout layout = source.layout.value_or(idf::Layout::of(newest));
  if (!(layout == (*model)->plan.layout())) return anew("it has another layout");
  const std::string why = misfit(**model, source.times.size(), options);
  if (!why.empty()) return anew(why);
  return WarmStart{*std::move(model), "training started from " + name};
}

void copy_weights(encoders::DeepModel& from, encoders::DeepModel& to) {
  torch::NoGradGuard no_grad;
  const int64_t from_scenes = from.autoencoder->shape.sizes.scenes;
  const int64_t to_scenes = to.autoencoder->shape.sizes.scenes;
  copy_parameters(*from.autoencoder, *to.autoencoder, from_scenes, to_scenes);
  copy_parameters(*from.dynamics, *to.dynamics, from_scenes, to_scenes);
}

}  // namespace engram::training
