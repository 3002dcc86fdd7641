// SPDX-License-Identifier: Apache-2.0
#include "speech/sights/sight_reading.h"

namespace engram::speech {

SeenKinds read_kinds(SightLayers& layers, const torch::Tensor& cells) {
  torch::NoGradGuard no_gradient;
  constexpr double kSmall = 1e-9;
  constexpr double kMinProbability = 1e-4;
  const SightLogits logits = layers->forward(cells);
  torch::Tensor kinds = torch::softmax(logits.kinds, 1).flatten(2);  // [B, kinds + 1, cells]
  kinds = kinds.slice(1, 0, kinds.size(1) - 1);                      // [B, kinds, cells]
  torch::Tensor weights = kinds.square();
  weights = weights / (weights.sum(2, true) + kSmall);
  const torch::Tensor places = torch::softmax(logits.places, 1).flatten(2).transpose(1, 2);
  const torch::Tensor colours =
      torch::log(torch::softmax(logits.colours, 1).flatten(2).transpose(1, 2) + kMinProbability);
  return {std::get<0>(kinds.max(2)), torch::matmul(weights, places),
          torch::matmul(weights, colours)};
}

}  // namespace engram::speech
