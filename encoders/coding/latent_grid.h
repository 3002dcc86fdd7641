// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace engram::encoders {

/// Size of one grid of integer latents, channels first.
struct LatentGrid {
  int channels = 0;
  int height = 1;
  int width = 1;

  [[nodiscard]] size_t count() const {
    return static_cast<size_t>(channels) * static_cast<size_t>(height) * static_cast<size_t>(width);
  }
  friend bool operator==(const LatentGrid&, const LatentGrid&) = default;
};

}  // namespace engram::encoders
