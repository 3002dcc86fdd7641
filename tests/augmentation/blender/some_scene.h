// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "augmentation/blender/scene.h"

namespace engram::augmentation {

inline PartPose at(double x, double y, double z) {
  return {1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z, 0, 0, 0, 1};
}

/// From (0, -2, 1.5) at a table top at the origin, x right; x' = right, y' = down, z' = forward.
inline PartPose camera_pose() {
  const double tilt = std::atan2(1.5, 2.0);
  return {1,
          0,
          0,
          0,  //
          0,
          -std::sin(tilt),
          std::cos(tilt),
          -2,  //
          0,
          -std::cos(tilt),
          -std::sin(tilt),
          1.5,
          0,
          0,
          0,
          1};
}

/// A table with a "box" and a "can" on it.
inline Scene some_scene() {
  Scene scene;
  scene.camera = {160, 120, 150, 150, 83.25, 55.5, camera_pose()};
  scene.shapes.push_back({"", ShapeKind::kBox, {0.8, 0.5, 0.02}, at(0, 0, -0.02), {0.5, 0.4, 0.3}});
  scene.shapes.push_back(
      {"box", ShapeKind::kBox, {0.1, 0.06, 0.15}, at(-0.3, 0, 0.15), {0.8, 0.2, 0.2}});
  scene.shapes.push_back(
      {"can", ShapeKind::kCylinder, {0.06, 0.06, 0.1}, at(0.3, 0.1, 0.1), {0.2, 0.3, 0.8}});
  scene.lamps.push_back({LampKind::kPoint, at(-1, -1, 2), 100, 0.1});
  return scene;
}

}  // namespace engram::augmentation
