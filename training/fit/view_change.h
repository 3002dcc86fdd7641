// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "encoders/torch.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// A change of the view that images show: a shifted camera, other light, a mirror image. Networks
/// trained on such views generalise to other recordings.
///
/// Source: docs/learning_methods.md, section "The image autoencoder".
struct ViewChange {
  double right = 0;       ///< Relative to the width.
  double down = 0;        ///< Relative to the height.
  double contrast = 1;    ///< A factor.
  double brightness = 0;  ///< Added. Unit: grey levels.
  bool is_mirrored = false;

  /// Draws a random change with LibTorch's random generator.
  static ViewChange draw(bool may_mirror);

  /// Changes all images in the same way. The edge is repeated outside the view.
  /// Shape: [N, C, H, W].
  [[nodiscard]] torch::Tensor of(const torch::Tensor& images) const;
};

}  // namespace engram::training
