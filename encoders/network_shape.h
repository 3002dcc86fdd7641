// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "encoders/coding/latent_grid.h"
#include "encoders/tensor_plan.h"

namespace engram::encoders {

/// What is known of an image member before training.
struct ImageShape {
  int channels = 3;
  int height = 0;  ///< Padded to a multiple of coarse_stride().
  int width = 0;
  int unit = 1;  ///< Pixels along a side that the networks see as one: more for large images.

  [[nodiscard]] int coarse_stride() const { return 16 * unit; }
  [[nodiscard]] int fine_stride() const { return 8 * unit; }
};

/// Sizes of the networks of one model, as a user may choose them.
struct NetworkSizes {
  int width = 64;            ///< Features where places are few, a multiple of 16; 0: no networks.
  int coarse_channels = 24;  ///< Latents per place of 16 x 16 units.
  int fine_channels = 8;     ///< Latents per place of 8 x 8 units.
  int scenes = 1;            ///< Backgrounds of each image member.
  int conditions = 0;        ///< Numbers of another entity that predictions start from.

  static constexpr int kMaxWidth = 512;
  static constexpr int kMaxChannels = 256;
  static constexpr int kMaxScenes = 64;
  /// Of an image member, of all scenes.
  static constexpr int64_t kMaxBackgroundPixels = int64_t{1} << 26;

  [[nodiscard]] bool is_valid() const;
};

/// What the networks of one model are made from.
struct NetworkShape {
  NetworkSizes sizes;
  std::vector<ImageShape> images;
  int numbers = 0;

  /// The grids of an image's latents, coarse and fine.
  [[nodiscard]] std::vector<LatentGrid> grids(size_t image) const;
};

/// Backgrounds of an image member that fit: at least one.
[[nodiscard]] int max_scenes(const ImageShape& image);

/// The shape for a layout.
[[nodiscard]] NetworkShape network_shape(const TensorPlan& plan, const NetworkSizes& sizes);

}  // namespace engram::encoders
