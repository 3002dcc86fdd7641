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
struct PlaceFeaturesImpl : torch::nn::Module {
  PlaceFeaturesImpl(const ImageShape& shape, const NetworkSizes& sizes);

  /// `background` [B, C, H, W] in units of kGreyLevels; `scene` of int64 [B], negative: none.
  View forward(const torch::Tensor& background, const torch::Tensor& scene);

  int unit;
  torch::Tensor place_16, place_8, place_4;  ///< By heart: of each scene, of all of them.
  torch::nn::Conv2d stem{nullptr}, to_eighth{nullptr}, out_eighth{nullptr}, to_sixteenth{nullptr};
  ResidualBlock quarter{nullptr}, eighth{nullptr};
};
TORCH_MODULE(PlaceFeatures);

}  // namespace engram::encoders
