// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "augmentation/image_change.h"

// Private to this room: the changes that the registry consists of.

namespace engram::augmentation {

std::unique_ptr<const ImageChange> make_recolour();
std::unique_ptr<const ImageChange> make_replace();
std::unique_ptr<const ImageChange> make_shift();
std::unique_ptr<const ImageChange> make_rotate();
std::unique_ptr<const ImageChange> make_occlude();
std::unique_ptr<const ImageChange> make_brightness();
std::unique_ptr<const ImageChange> make_contrast();
std::unique_ptr<const ImageChange> make_temperature();
std::unique_ptr<const ImageChange> make_blur();
std::unique_ptr<const ImageChange> make_noise();

/// The largest seed. Every JSON reader keeps integers of this size exactly.
inline constexpr int64_t kMaxSeed = (int64_t{1} << 48) - 1;

/// Draws a number of either sign. Its magnitude is at most `max` at full strength.
[[nodiscard]] inline int64_t draw_around_zero(Random& random, int64_t max, int strength_percent) {
  const int64_t reach = max * strength_percent / 100;
  return random.between(-reach, reach);
}

}  // namespace engram::augmentation
