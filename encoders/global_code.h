// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "encoders/autoencoder.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::encoders {

/// Numbers of a global code.
inline constexpr int64_t kGlobalCodeSize = 48;

/// Means of the coarse latents of all images over up to 4 x 4 cells of their grids: the input of a
/// global code.
/// Shape: [B, P], where P is pooled_size().
[[nodiscard]] torch::Tensor pooled_latents(const Latents& latents);

/// The P of pooled_latents; 0 without networks.
[[nodiscard]] int64_t pooled_size(const NetworkShape& shape);

/// A code of 48 numbers per snapshot whose distance is small for snapshots that look similar: a
/// projection of pooled latents plus an offset per background. The distance of two codes is about
/// the root mean square difference of the snapshots as images of 8 x 8 pixels.
/// Unit: grey levels.
///
///     coarse latents, rounded --> pooled_latents [B, P] --> projection --(+)--> [B, 48]
///     scene [B] --> offset ------------------------------------------------+
///
/// B is the batch and P is pooled_size(). Both tensors are fitted in closed form: a ridge
/// regression of the small images on pooled latents, then the principal components of its result.
/// The method is our own.
/// Source: docs/learning_methods.md, section "Global codes".
struct GlobalCode {
  torch::Tensor projection;  ///< [kGlobalCodeSize, P]; undefined if the model has no global code.
  torch::Tensor offset;      ///< [scenes, kGlobalCodeSize].

  [[nodiscard]] bool is_known() const { return projection.defined(); }
  /// Computes codes from rounded latents of every image member.
  /// Shape: [B, kGlobalCodeSize].
  [[nodiscard]] torch::Tensor of(const Latents& latents) const;
};

}  // namespace engram::encoders
