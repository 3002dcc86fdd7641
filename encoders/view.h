// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "encoders/layers.h"
#include "encoders/network_shape.h"

// Internal to the learning rooms: includes LibTorch. Letters as in autoencoder.h.

namespace engram::encoders {

/// What is known of images before their latents: the background, and what follows from it. Each row
/// stands for as many rows of images, one after the other.
struct View {
  torch::Tensor background;  ///< [B, C, H, W], in units of kGreyLevels.
  torch::Tensor sixteenth;   ///< Features of places: [B, F, H/16, W/16],
  torch::Tensor eighth;      ///< [B, 3F/4, H/8, W/8],
  torch::Tensor quarter;     ///< [B, 3F/8, H/4, W/4], for images of one unit.
};

/// One per image member.
using Views = std::vector<View>;

/// What encoder and decoder are told of places: a network that reads the background, and, where the
/// scene is one that was trained on, what was learned of it by heart. Views that are new, or that
/// are shifted, have their background alone.
///
///     background [B, C, H, W]
///           | unshuffle by 4, stem 3x3
///     [B, 3F/8, H/4, W/4]  quarter: 1 block --------------- + quarter_by_heart --> quarter
///           | to_eighth
///     [B, F/2, H/8, W/8]   eighth: 1 block - out_eighth 1x1 + eighth_by_heart ---> eighth
///           | to_sixteenth
///     [B, F, H/16, W/16] ---------------------------------- + sixteenth_by_heart > sixteenth
///
/// On the right are the members of View.
///
/// Source: our own.
struct PlaceFeaturesImpl : torch::nn::Module {
  PlaceFeaturesImpl(const ImageShape& shape, const NetworkSizes& sizes);

  /// `background` [B, C, H, W] in units of kGreyLevels; `scene` of int64 [B], negative: none.
  View forward(const torch::Tensor& background, const torch::Tensor& scene);

  int unit;
  torch::Tensor sixteenth_by_heart;  ///< [scenes, F, H/16, W/16]
  torch::Tensor eighth_by_heart;     ///< [1, 3F/4, H/8, W/8], of all scenes.
  torch::Tensor quarter_by_heart;    ///< [1, 3F/8, H/4, W/4], of all scenes.
  torch::nn::Conv2d stem{nullptr}, to_eighth{nullptr}, out_eighth{nullptr}, to_sixteenth{nullptr};
  ResidualBlock quarter{nullptr}, eighth{nullptr};
};
TORCH_MODULE(PlaceFeatures);

}  // namespace engram::encoders
