// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>

#include "augmentation/scene_images.h"

// Private to this room.

namespace engram::augmentation {

[[nodiscard]] inline uint8_t to_grey_level(int64_t value) {
  return static_cast<uint8_t>(std::clamp<int64_t>(value, 0, 255));
}

/// Divides and rounds to the nearest integer, halves away from zero. `divisor` must be positive.
[[nodiscard]] constexpr int64_t divided(int64_t value, int64_t divisor) {
  return (value >= 0 ? value + divisor / 2 : value - divisor / 2) / divisor;
}

/// The lightness of a pixel, 0 to 255, with the weights of BT.601. Shape: `pixel` [channels].
[[nodiscard]] inline int64_t lightness_of(const uint8_t* pixel, int channels) {
  if (channels == 1) return pixel[0];
  return (77 * pixel[0] + 150 * pixel[1] + 29 * pixel[2] + 128) >> 8;
}

/// Replaces every grey level of the light images by what `of` returns for its channel and level.
/// The only channel of a grey image counts as green.
void map_levels(SceneImages& images, const std::function<int64_t(int channel, int level)>& of);

}  // namespace engram::augmentation
