// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: how the drawn scene looks (datasets/drawn_scene.h). Throws cv::Exception.

#include <opencv2/core.hpp>

#include "datasets/scene_plan.h"

namespace engram::datasets::scene {

/// Draws moments of the scene before a room that it makes once.
///
/// Threading: const-parallel.
class Painter {
 public:
  explicit Painter(const SceneOptions& options);

  /// Draws into `image`, of type CV_8UC3 and the size of the options. `frame` chooses the noise.
  void paint(const Moment& moment, uint64_t frame, cv::Mat& image) const;

 private:
  SceneOptions options_;
  cv::Mat background_;  ///< kOversampling times as large as the image.
};

}  // namespace engram::datasets::scene
