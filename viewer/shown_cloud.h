// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "ltm/idf/ndarray.h"

namespace engram::viewer {

/// Points as the scene draws them, at most as many as were asked for.
struct ShownCloud {
  std::vector<float> points;  ///< Shape: [count, 3], x, y, z. Unit: m.
  uint64_t known = 0;         ///< Points that the value has a place for, of which these are some.
};

/// A camera that has no distortion: u = fx x / z + cx, and (0, 0) is the centre of the pixel at the
/// top left. Unit: pixels.
struct DepthCamera {
  double fx = 0;
  double fy = 0;
  double cx = 0;
  double cy = 0;
};

/// The points that a depth image shows. Depth of zero is not known, and has no point.
///
/// Where there are more than `max_points`, every n-th is kept, evenly spread over the image.
/// Shape: uint16 or float32 [H, W, 1]. Unit: `unit_m` is how many metres a depth of 1 is. Frame: of
/// the camera, x right, y down, z forward.
[[nodiscard]] ShownCloud cloud_of_depth(const idf::NdArray& depth, const DepthCamera& camera,
                                        double unit_m, size_t max_points);

/// The first three columns of an array as points, likewise. Rows that are not finite have no point.
/// Shape: any numbers [N, 3 or more].
[[nodiscard]] ShownCloud cloud_of_rows(const idf::NdArray& rows, size_t max_points);

}  // namespace engram::viewer
