// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "encoders/torch.h"

// Private to this room: includes LibTorch.

namespace engram::speech {

/// Sizes of a network.
struct SightShape {
  int64_t channels = 0;  ///< Of the cells of an image.
  int64_t kinds = 0;     ///< Of things.
  int64_t places = 0;    ///< Where things may be.
  int64_t colours = 0;

  static constexpr int64_t kWidth = 64;
  static constexpr int64_t kColourWidth = 32;
};

/// What each cell of B images says, as logits.
struct SightLogits {
  torch::Tensor kinds;    ///< [B, kinds + 1, R, C]; the last is nothing.
  torch::Tensor places;   ///< [B, places, R, C], of the thing that is there.
  torch::Tensor colours;  ///< [B, colours, R, C]
};

/// The network that sees things in latents.
///
///     cells --+-- 3x3 -- 3x3 + -- 3x3, every other cell + --+-- kinds
///             |                        |                    '-- places
///             |         mean of all ---'
///             '-- 3x3 ---- colours
///
/// Each cell says which thing is in it, and where that thing is, from what is around it and what
/// the whole image is like. Colours are read from the nearest cells alone: with all of the image
/// the network learns by heart which recording has which colours. Trained on 16 kitchens, it read
/// 34 % of the colours in 5 others rightly with the whole image, 50 % without it, and 66 % with
/// changed copies of the images besides (chance: 18 %).
struct SightLayersImpl : torch::nn::Module {
  explicit SightLayersImpl(const SightShape& shape);

  /// Shape: cells [B, channels, R, C].
  SightLogits forward(const torch::Tensor& cells);

  /// Sets what the cells are normalised by. Shape: [N, channels, R, C].
  void fit_normaliser(const torch::Tensor& cells);

  torch::Tensor mean, deviation;  ///< [1, channels, 1, 1]
  torch::nn::Conv2d near{nullptr}, around{nullptr}, wide{nullptr}, told{nullptr};
  torch::nn::Conv2d tint{nullptr}, tint_told{nullptr};
  torch::nn::Linear whole{nullptr};

 private:
  SightShape shape_;
};
TORCH_MODULE(SightLayers);

}  // namespace engram::speech
