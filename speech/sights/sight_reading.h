// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "speech/sights/sight_layers.h"

// Private to this room: includes LibTorch.

namespace engram::speech {

/// What a network says of the kinds of things in B images, from all cells together.
struct SeenKinds {
  torch::Tensor sight;    ///< [B, kinds], how probable it is that a thing of the kind is in sight.
  torch::Tensor places;   ///< [B, kinds, places], probabilities where it is, if it is in sight.
  torch::Tensor colours;  ///< [B, kinds, colours], mean logarithms of probabilities.
};

/// A kind is in sight as surely as in the cell that is surest. Where it is and which colour it has
/// is read from all cells, which count by the squares of their probabilities of the kind.
/// Shape: cells [B, channels, R, C].
[[nodiscard]] SeenKinds read_kinds(SightLayers& layers, const torch::Tensor& cells);

}  // namespace engram::speech
