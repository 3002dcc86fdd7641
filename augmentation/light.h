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

/// Rounded to the nearest, halves away from zero. `divisor` is positive.
[[nodiscard]] constexpr int64_t divided(int64_t value, int64_t divisor) {
  return (value >= 0 ? value + divisor / 2 : value - divisor / 2) / divisor;
}

/// How light a pixel is, 0 to 255, with the weights of BT.601. Shape: `pixel` [channels].
[[nodiscard]] inline int64_t lightness_of(const uint8_t* pixel, int channels) {
  if (channels == 1) return pixel[0];
  return (77 * pixel[0] + 150 * pixel[1] + 29 * pixel[2] + 128) >> 8;
}

/// Replaces every grey level of light by what `of` says of its channel and level. One channel
/// counts as green.
void map_levels(SceneImages& images, const std::function<int64_t(int channel, int level)>& of);

}  // namespace engram::augmentation
