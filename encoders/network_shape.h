// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "encoders/coding/latent_grid.h"
#include "encoders/tensor_plan.h"

namespace engram::encoders {

/// Size of an image member as the networks see it.
struct ImageShape {
  int channels = 3;
  int height = 0;  ///< Padded to a multiple of coarse_stride().
  int width = 0;
  /// Pixels along the side of one unit of the networks; more than 1 for large images.
  int unit = 1;

  [[nodiscard]] int coarse_stride() const { return 16 * unit; }
  [[nodiscard]] int fine_stride() const { return 8 * unit; }
};

/// Sizes of the networks of one model, as a user may choose them.
struct NetworkSizes {
  /// Features at 1/16 of the resolution, a multiple of 16; 0 for no networks.
  int width = 64;
  int coarse_channels = 24;  ///< Latents per cell of 16 x 16 units.
  int fine_channels = 8;     ///< Latents per cell of 8 x 8 units.
  int scenes = 1;            ///< Backgrounds of each image member.
  int conditions = 0;        ///< Numbers of another entity that condition predictions.

  static constexpr int kMaxWidth = 512;
  static constexpr int kMaxChannels = 256;
  static constexpr int kMaxScenes = 64;
  /// Of all scenes of one image member.
  static constexpr int64_t kMaxBackgroundPixels = int64_t{1} << 26;

  [[nodiscard]] bool is_valid() const;
};

/// The sizes from which the networks of one model are made.
struct NetworkShape {
  NetworkSizes sizes;
  std::vector<ImageShape> images;
  int numbers = 0;

  /// The grids of the latents of an image: coarse, then fine.
  [[nodiscard]] std::vector<LatentGrid> grids(size_t image) const;
};

/// Maximum number of backgrounds of an image member: at least one.
[[nodiscard]] int max_scenes(const ImageShape& image);

/// The shape of the networks for a layout.
[[nodiscard]] NetworkShape network_shape(const TensorPlan& plan, const NetworkSizes& sizes);

}  // namespace engram::encoders
