// SPDX-License-Identifier: Apache-2.0
#include "encoders/weight_rounding.h"

#include <cmath>

#include "encoders/layers.h"

namespace engram::encoders {

using torch::Tensor;

float weight_scale(float largest) {
  if (!(largest > 0)) return 1.0f;
  // The scale has so few bits that 127 * scale is exact. So rounding rounded weights changes
  // nothing.
  int exponent = 0;
  const float fraction = std::frexp(largest / 127.0f, &exponent);
  return std::ldexp(std::ceil(fraction * 1024.0f) / 1024.0f, exponent);
}

Kept kept_as(const std::string& name, const Tensor& tensor, bool is_buffer) {
  if (name.ends_with("background")) return Kept::kPixels;
  const bool is_matrix = tensor.dim() == 2 || tensor.dim() == 4;
  return is_matrix && !is_buffer ? Kept::kBytes : Kept::kFloats;
}

void round_rows(Tensor& weights) {
  Tensor scales = weights.flatten(1).abs().amax(1).contiguous();
  auto* scale = scales.data_ptr<float>();
  for (int64_t row = 0; row < scales.numel(); ++row) scale[row] = weight_scale(scale[row]);
  std::vector<int64_t> shape(static_cast<size_t>(weights.dim()), 1);
  shape.front() = -1;
  scales = scales.reshape(shape);
  weights.div_(scales).round_().clamp_(-127, 127).mul_(scales);
}

void round_weights(torch::nn::Module& module) {
  torch::NoGradGuard no_grad;
  for (auto& item : module.named_parameters()) {
    Tensor& weights = item.value();
    const Kept kept = kept_as(item.key(), weights, false);
    if (kept == Kept::kPixels)
      weights.mul_(kGreyLevels).round_().clamp_(0, 255).div_(kGreyLevels);
    else if (kept == Kept::kBytes)
      round_rows(weights);
  }
}

RoundedWeights::RoundedWeights(torch::nn::Module& module) : module_(module) {
  torch::NoGradGuard no_grad;
  for (const Tensor& weights : module.parameters()) exact_.push_back(weights.clone());
  round_weights(module);
}

void RoundedWeights::restore() {
  torch::NoGradGuard no_grad;
  auto weights = module_.parameters();
  for (size_t i = 0; i < exact_.size(); ++i) weights[i].copy_(exact_[i]);
  exact_.clear();
}

}  // namespace engram::encoders
