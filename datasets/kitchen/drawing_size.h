// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace engram::datasets {

struct KitchenOptions;

namespace kitchen {

/// The size and quality of the pictures to draw. Unit: pixels.
struct DrawingSize {
  int width = 640;
  int height = 480;
  int samples = 4;        ///< Samples per pixel; 0 for no smoothing.
  int shadow_map = 2048;  ///< Side of the shadow map; 0 for no shadows.
  /// False: surfaces have no pictures, because nothing is drawn. Painting takes 0.3 s.
  bool is_painted = true;
};

/// Returns what a recording or a live kitchen of these options draws.
[[nodiscard]] DrawingSize drawing_size(const KitchenOptions& options);

}  // namespace kitchen
}  // namespace engram::datasets
