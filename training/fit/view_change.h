// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "encoders/torch.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Another view of what images show: the camera shifted, other light, mirrored. What is trained on
/// such views carries over to recordings that it was not trained on.
///
/// Source: docs/learning.md, section "The image autoencoder".
struct ViewChange {
  double right = 0;       ///< Relative to the width.
  double down = 0;        ///< Relative to the height.
  double contrast = 1;    ///< A factor.
  double brightness = 0;  ///< Added. Unit: grey levels.
  bool is_mirrored = false;

  /// Uses LibTorch's random generator.
  static ViewChange draw(bool may_mirror);

  /// Repeats the edge where nothing was seen. Shape: [N, C, H, W], all changed alike.
  [[nodiscard]] torch::Tensor of(const torch::Tensor& images) const;
};

}  // namespace engram::training
