// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "encoders/layers.h"
#include "encoders/network_shape.h"

// Internal to the learning rooms: includes LibTorch. Letters as in autoencoder.h.

namespace engram::encoders {

/// The knowledge about images before their latents: the background and features computed from it.
/// Each row of a view applies to an equal number of consecutive rows of images.
struct View {
  torch::Tensor background;  ///< [B, C, H, W], in units of kGreyLevels.
  torch::Tensor sixteenth;   ///< Features of places: [B, F, H/16, W/16],
  torch::Tensor eighth;      ///< [B, 3F/4, H/8, W/8],
  torch::Tensor quarter;     ///< [B, 3F/8, H/4, W/4], for images of one unit.
};

/// One per image member.
using Views = std::vector<View>;

/// Makes the features of places for encoder and decoder. A network reads the background; if the
/// scene is a trained one, parameters that memorise it are added. New or shifted views have their
/// background alone.
///
///     background [B, C, H, W]
///           | unshuffle by 4, stem 3x3
///     [B, 3F/8, H/4, W/4]  quarter: 1 block --------------- + quarter_by_heart --> quarter
///           | to_eighth
///     [B, F/2, H/8, W/8]   eighth: 1 block - out_eighth 1x1 + eighth_by_heart ---> eighth
///           | to_sixteenth
///     [B, F, H/16, W/16] ---------------------------------- + sixteenth_by_heart > sixteenth
///
/// The members of View are on the right. "..._by_heart" are the memorised parameters.
///
/// Source: our own.
struct PlaceFeaturesImpl : torch::nn::Module {
  PlaceFeaturesImpl(const ImageShape& shape, const NetworkSizes& sizes);

  /// `background` [B, C, H, W] in units of kGreyLevels; `scene` of int64 [B], negative if it is no
  /// trained scene.
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
