// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "encoders/torch.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::encoders {

/// Rounds all weights to what a model file keeps: 8 bits per weight and a scale per output
/// channel, whole grey levels for backgrounds, 32-bit floats for vectors.
void round_weights(torch::nn::Module& module);

/// Rounds weights to 8 bits each and one scale for each of the first axis.
void round_rows(torch::Tensor& weights);

/// Rounds the weights of a module until it is told to restore them: gradients of rounded weights
/// are added to exact ones.
///
/// Threading: one thread.
class RoundedWeights {
 public:
  /// The module outlives it.
  explicit RoundedWeights(torch::nn::Module& module);
  ~RoundedWeights() { restore(); }
  RoundedWeights(const RoundedWeights&) = delete;
  RoundedWeights& operator=(const RoundedWeights&) = delete;

  void restore();

 private:
  torch::nn::Module& module_;
  std::vector<torch::Tensor> exact_;
};

/// How a model file keeps a tensor.
enum class Kept { kBytes, kPixels, kFloats };
[[nodiscard]] Kept kept_as(const std::string& name, const torch::Tensor& tensor, bool is_buffer);

/// Scale of one output channel, such that weights are scale * [-127, 127]; exact when repeated.
[[nodiscard]] float weight_scale(float largest);

}  // namespace engram::encoders
