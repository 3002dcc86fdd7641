// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "augmentation/scene_images.h"

// Private to this room.

namespace engram::augmentation {

/// The number one in fixed point. Unit: 2^-30.
inline constexpr int64_t kUnit = int64_t{1} << 30;

/// A rotation about the middle of an image, followed by a shift. All images of a scene move alike,
/// even if their sizes differ, because shifts are fractions of the sides.
/// Frame: x to the right, y down; positive angles turn clockwise as seen.
struct Move {
  int64_t cosine = kUnit;  ///< Unit: 2^-30.
  int64_t sine = 0;        ///< Unit: 2^-30.
  int64_t right_permille = 0;
  int64_t down_permille = 0;

  /// A rotation of at most 45 degrees either way. The result is the same on every machine.
  static Move turn(int64_t millidegrees);

  /// Moves images, labels and points. In light images, pixels that were not seen repeat the edge;
  /// in labels and depth they become zero. Light is interpolated; labels and depth take the value
  /// of the nearest pixel.
  void apply(SceneImages& images) const;
};

}  // namespace engram::augmentation
