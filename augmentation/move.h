// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "augmentation/scene_images.h"

// Private to this room.

namespace engram::augmentation {

/// Numbers of 2^-30.
inline constexpr int64_t kUnit = int64_t{1} << 30;

/// A turn about the middle of an image, then a shift. All images of a scene move alike, also where
/// their sizes differ: shifts are parts of the sides.
/// Frame: x to the right, y down; positive angles turn clockwise as seen.
struct Move {
  int64_t cosine = kUnit;  ///< Unit: 2^-30.
  int64_t sine = 0;        ///< The same.
  int64_t right_permille = 0;
  int64_t down_permille = 0;

  /// Up to 45 degrees either way; the same on every machine.
  static Move turn(int64_t millidegrees);

  /// Moves images, labels and points. What was not seen repeats the edge; in labels and depth it is
  /// zero. Light is interpolated, others are taken from the nearest pixel.
  void apply(SceneImages& images) const;
};

}  // namespace engram::augmentation
