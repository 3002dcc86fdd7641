// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "encoders/layers.h"
#include "encoders/network_shape.h"

// Internal to the learning rooms: includes LibTorch. Letters as in autoencoder.h.

namespace engram::encoders {

/// Continues the motion of the last two images without latents. It blends the last image, warped by
/// a learned flow, with the result of optical flow, and corrects what is left under a mask.
///
///     image(k) = (1 - share(k)) * warp(last, flow(k)) + share(k) * moved(k) + mask(k) * mend(k)
///
/// Before training the result lies between a copy of the last image and the moved one. The network
/// has no parameters of places or scenes, so it generalises to recordings that it was not trained
/// on.
///
///     last, change, |change|, moved - last   [B, (3 + kSteps) C, H, W]
///           | unshuffle by 4, stem 3x3
///     [B, M, H/4, W/4]     quarter_down ------------------------------(+)- quarter_up - out 3x3
///           | to_eighth                                                 | from_eighth
///     [B, 2M, H/8, W/8]    eighth_down --------------(+)- eighth_up ----+
///           | to_sixteenth                            | from_sixteenth
///     [B, 4M, H/16, W/16]  + from_added - sixteenth --+
///
/// `sixteenth` has three residual blocks, the others have one each. For each step, `out` gives a
/// flow [B, 2, H/4, W/4], mend [B, C, H, W], and mask and share [B, 1, H, W] each. M is `features`,
/// the number of features at 1/4.
///
/// Source: docs/learning_methods.md, section "Prediction". The shape follows Ronneberger et al.,
/// U-Net, 2015; images are warped as in Jaderberg et al., Spatial Transformer Networks, 2015.
struct ImageMotionImpl : torch::nn::Module {
  /// `added` is the number of added features in every call, or 0.
  ImageMotionImpl(const ImageShape& shape, int features, int added);

  /// Steps that one call looks ahead.
  static constexpr int kSteps = 2;

  /// Predicts the next kSteps images after `last`, in grey levels, not clamped. `before` is the
  /// image before `last`, and `moved` is the result of moved_on().
  /// Shape: images [B, C, H, W]; moved [B, kSteps, C, H, W]; added [B, added] or undefined.
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

/// Samples x [B, C, H, W] at places that are displaced by `flow` [B, 2, H, W], to the right and
/// down. The edge is repeated.
/// Unit: pixels.
[[nodiscard]] torch::Tensor warp(const torch::Tensor& x, const torch::Tensor& flow);

}  // namespace engram::encoders
