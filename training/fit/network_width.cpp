// SPDX-License-Identifier: Apache-2.0
#include "training/fit/network_width.h"

#include <array>
#include <utility>

#include "encoders/deep_model.h"

namespace engram::training {

// Wider networks pay for their bytes in the model file only with more snapshots. Source:
// docs/learning_methods.md, section "What is stored".
int network_width(const TrainOptions& options, size_t snapshots) {
  if (!options.has_networks) return 0;
  if (options.width > 0) return options.width;
  if (snapshots < 2000) return 64;
  return snapshots < 20000 ? 96 : 128;
}

uint64_t network_bytes(const idf::Layout& layout, const TrainOptions& options) {
  auto plan = encoders::TensorPlan::create(layout);
  if (!plan.ok() || plan->images().empty()) return 0;
  const encoders::DeepModel model(
      std::move(*plan), {options.width, options.coarse_channels, options.fine_channels, 1, 0});
  int64_t weights = 0;
  for (const auto& tensor : model.autoencoder->parameters()) weights += tensor.numel();
  for (const auto& tensor : model.dynamics->parameters()) weights += tensor.numel();
  return static_cast<uint64_t>(weights);
}

int width_that_pays(const idf::Layout& layout, const TrainOptions& options, double saved_bytes) {
  constexpr std::array kWidths{128, 96, 64, 48, 32};
  for (const int width : kWidths) {
    TrainOptions tried = options;
    tried.width = width;
    const auto bytes = static_cast<double>(network_bytes(layout, tried));
    if (bytes > 0 && bytes <= kMaxModelShare * saved_bytes) return width;
  }
  return 0;
}

}  // namespace engram::training
