// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "training/fit/stage_times.h"

namespace engram::training {

/// What the work on an entity cost in one night.
struct EntityCosts {
  StageTimes stages;
  /// Images that were encoded, each as often as that happened: with the new model, again as video
  /// alone, and with the previous model. Samples for the plan do not count.
  uint64_t images_encoded = 0;
  /// The video codec with its effort, as "av1:effort=6"; empty if no images were encoded as video.
  std::string video;
  /// Lossy encodes of each search for a video, one search per chain and image member.
  std::vector<int> encodes;
  uint64_t known_videos = 0;  ///< Videos that were not searched for, but found before.

  /// NaN without searches, like the next.
  [[nodiscard]] double mean_encodes() const;
  [[nodiscard]] double median_encodes() const;
};

}  // namespace engram::training
