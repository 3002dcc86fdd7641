// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "encoders/torch.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::encoders {

/// Rounds all weights to the precision of a model file: 8 bits per weight and one scale per output
/// channel, whole grey levels for backgrounds, 32-bit floats for vectors.
void round_weights(torch::nn::Module& module);

/// Rounds weights to 8 bits each, with one scale per index of the first axis.
void round_rows(torch::Tensor& weights);

/// Rounds the weights of a module until restore(). Training computes gradients with the rounded
/// weights and applies them to the exact ones.
///
/// Threading: one thread.
class RoundedWeights {
 public:
  /// The module must outlive this object.
  explicit RoundedWeights(torch::nn::Module& module);
  ~RoundedWeights() { restore(); }
  RoundedWeights(const RoundedWeights&) = delete;
  RoundedWeights& operator=(const RoundedWeights&) = delete;

  void restore();

 private:
  torch::nn::Module& module_;
  std::vector<torch::Tensor> exact_;
};

/// The way in which a model file keeps a tensor.
enum class Kept { kBytes, kPixels, kFloats };
[[nodiscard]] Kept kept_as(const std::string& name, const torch::Tensor& tensor, bool is_buffer);

/// Scale of one output channel, such that weights are scale * [-127, 127]. Rounding rounded weights
/// again changes nothing.
[[nodiscard]] float weight_scale(float largest);

}  // namespace engram::encoders
