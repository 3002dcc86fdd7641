// SPDX-License-Identifier: Apache-2.0
#include "encoders/weight_rounding.h"

#include <cmath>

#include "encoders/layers.h"

namespace engram::encoders {

using torch::Tensor;

float weight_scale(float largest) {
  if (!(largest > 0)) return 1.0f;
  // Few enough bits that 127 * scale is exact: rounding rounded weights changes nothing.
  int exponent = 0;
  const float fraction = std::frexp(largest / 127.0f, &exponent);
  return std::ldexp(std::ceil(fraction * 1024.0f) / 1024.0f, exponent);
}

Kept kept_as(const std::string& name, const Tensor& tensor, bool is_buffer) {
  if (name.ends_with("background")) return Kept::kPixels;
  const bool is_matrix = tensor.dim() == 2 || tensor.dim() == 4;
  return is_matrix && !is_buffer ? Kept::kBytes : Kept::kFloats;
}

void round_weights(torch::nn::Module& module) {
  torch::NoGradGuard no_grad;
  for (auto& item : module.named_parameters()) {
    Tensor& weights = item.value();
    const Kept kept = kept_as(item.key(), weights, false);
    if (kept == Kept::kPixels) {
      weights.copy_((weights * kGreyLevels).round().clamp(0, 255) / kGreyLevels);
    } else if (kept == Kept::kBytes) {
      for (int64_t row = 0; row < weights.size(0); ++row) {
        Tensor channel = weights.select(0, row);
        const float scale = weight_scale(channel.abs().max().item<float>());
        channel.copy_((channel / scale).round().clamp(-127, 127) * scale);
      }
    }
  }
}

}  // namespace engram::encoders
