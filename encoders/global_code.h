// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "encoders/autoencoder.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::encoders {

/// Numbers of a global code.
inline constexpr int64_t kGlobalCodeSize = 48;

/// Means of the coarse latents of all images over a few cells of their grids: what a global code is
/// made from. Shape: [B, P], P = pooled_size().
[[nodiscard]] torch::Tensor pooled_latents(const Latents& latents);

/// The P of pooled_latents; 0 without networks.
[[nodiscard]] int64_t pooled_size(const NetworkShape& shape);

/// A few numbers per snapshot that are near each other where snapshots look alike: a projection of
/// pooled latents, and an offset per background. Their distance is about that of the small images
/// that training fitted it to. Unit: grey levels, root mean square.
///
///     coarse latents, rounded --> pooled_latents [B, P] --> projection --(+)--> [B, 48]
///     scene [B] --> offset ------------------------------------------------+
///
/// P is pooled_size(). Both tensors are fitted in closed form: ridge regression of the small images
/// on pooled latents, then principal components of what that explains. Our own.
/// Source: docs/learning_methods.md, section "Global codes".
struct GlobalCode {
  torch::Tensor projection;  ///< [kGlobalCodeSize, P]; undefined where a model has none.
  torch::Tensor offset;      ///< [scenes, kGlobalCodeSize].

  [[nodiscard]] bool is_known() const { return projection.defined(); }
  /// Shape: [B, kGlobalCodeSize]. Needs rounded latents of every image member.
  [[nodiscard]] torch::Tensor of(const Latents& latents) const;
};

}  // namespace engram::encoders
