// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the appearance of the drawn scene (datasets/drawn_scene.h). Throws
// cv::Exception.

#include <opencv2/core.hpp>

#include "datasets/scene_plan.h"

namespace engram::datasets::scene {

/// Draws moments of the scene in front of a room that is drawn only once.
///
/// Threading: const-parallel.
class Painter {
 public:
  explicit Painter(const SceneOptions& options);

  /// Draws into `image`, which has type CV_8UC3 and the size of the options. `frame` selects the
  /// noise.
  void paint(const Moment& moment, uint64_t frame, cv::Mat& image) const;

 private:
  SceneOptions options_;
  cv::Mat background_;  ///< kOversampling times as large as the image on each side.
};

}  // namespace engram::datasets::scene
