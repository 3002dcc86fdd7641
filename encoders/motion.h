// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "encoders/layers.h"
#include "encoders/network_shape.h"

// Internal to the learning rooms: includes LibTorch. Letters as in autoencoder.h.

namespace engram::encoders {

/// Continues the motion of the last two images, without latents: between the last one, moved by a
/// learned flow, and what optical flow makes of it, and what both leave wrong is mended under a
/// mask.
///
///     image(k) = (1 - share(k)) * warp(last, flow(k)) + share(k) * moved(k) + mask(k) * mend(k)
///
/// It starts between a copy of the last image and the moved one. It knows no places and no scene,
/// and so carries over to recordings that it was not trained on.
///
///     last, change, |change|, moved - last   [B, (3 + kSteps) C, H, W]
///           | unshuffle by 4, stem 3x3
///     [B, M, H/4, W/4]     quarter_down ------------------------------(+)- quarter_up - out 3x3
///           | to_eighth                                                 | from_eighth
///     [B, 2M, H/8, W/8]    eighth_down --------------(+)- eighth_up ----+
///           | to_sixteenth                            | from_sixteenth
///     [B, 4M, H/16, W/16]  + from_added - sixteenth --+
///
/// sixteenth has three residual blocks, the others have one each.
/// out, per step: a flow [B, 2, H/4, W/4]; mend [B, C, H, W], mask and share [B, 1, H, W] each.
/// M is `features`.
///
/// Source: docs/learning_methods.md, section "Prediction". The shape follows Ronneberger et al.,
/// U-Net, 2015; images are warped as in Jaderberg et al., Spatial Transformer Networks, 2015.
struct ImageMotionImpl : torch::nn::Module {
  /// `added` features come with every call; 0: none.
  ImageMotionImpl(const ImageShape& shape, int features, int added);

  /// Steps that one call looks ahead.
  static constexpr int kSteps = 2;

  /// The next images after `last`, `before` the one before it, all in grey levels [B, C, H, W], not
  /// clamped. `moved` [B, kSteps, C, H, W] are those of moved_on(). `added` [B, added] or
  /// undefined.
  std::vector<torch::Tensor> forward(const torch::Tensor& last, const torch::Tensor& before,
                                     const torch::Tensor& moved, const torch::Tensor& added);

  int unit, channels;
  torch::nn::Conv2d stem{nullptr}, to_eighth{nullptr}, to_sixteenth{nullptr};
  torch::nn::Conv2d from_sixteenth{nullptr}, from_eighth{nullptr}, out{nullptr};
  ResidualBlock quarter_down{nullptr}, quarter_up{nullptr};
  ResidualBlock eighth_down{nullptr}, eighth_up{nullptr};
  ResidualBlocks sixteenth{nullptr};
  torch::nn::Linear from_added{nullptr};
};
TORCH_MODULE(ImageMotion);

/// x [B, C, H, W] read at places that lie off by `flow` [B, 2, H, W], to the right and down; beyond
/// the edge it is repeated. Unit: pixels.
[[nodiscard]] torch::Tensor warp(const torch::Tensor& x, const torch::Tensor& flow);

}  // namespace engram::encoders
