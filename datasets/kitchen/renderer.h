// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the images of the robot's cameras.

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "datasets/kitchen/world.h"
#include "ltm/idf/ndarray.h"

namespace engram::datasets::kitchen {

/// A pinhole camera without distortion: u = focal x / z + centre_x, where (0, 0) is the middle of
/// the top left pixel. Unit: pixels.
struct Pinhole {
  double focal = 0;
  double centre_x = 0;
  double centre_y = 0;

  static Pinhole of(const DrawingSize& size);

  /// Projects a point in front of the camera (z > 0). Frame: camera, z forward.
  [[nodiscard]] Eigen::Vector2d project(const Eigen::Vector3d& point_m) const {
    return {focal * point_m.x() / point_m.z() + centre_x,
            focal * point_m.y() / point_m.z() + centre_y};
  }

  /// Returns true if a point is in front of the camera and within its image. Frame: camera.
  [[nodiscard]] bool shows(const Eigen::Vector3d& point_m, const DrawingSize& size) const;
};

/// The images of both cameras at one time.
struct StereoPicture {
  /// Shape: uint8 [height, width, 3], RGB.
  idf::NdArray left;
  idf::NdArray right;
  /// Depth of the left camera. Shape: [height][width], row-major. Unit: mm, rounded; 65535 if the
  /// depth is larger.
  std::vector<uint16_t> depth_mm;
};

/// Draws a world with MuJoCo's renderer, without a display.
///
/// Equal worlds give equal pixels on one machine.
/// Threading: only the thread that made it.
class Renderer {
 public:
  /// Errors: kUnavailable if there is no OpenGL, or none that draws into memory.
  static Result<std::unique_ptr<Renderer>> create(const World& world, const DrawingSize& size);
  ~Renderer();

  StereoPicture draw(const World& world, bool with_depth);

  /// Returns both images of a thing alone: 255 where it is, 0 elsewhere.
  /// Shape: uint8 [height, width, 1].
  std::pair<idf::NdArray, idf::NdArray> draw_mask(const World& world, size_t thing);

  /// Draws the room from any point. Frame: world. Shape: uint8 [height, 2 width, 3], RGB.
  idf::NdArray draw_from(const World& world, const Eigen::Vector3d& eye,
                         const Eigen::Vector3d& target);

 private:
  struct Parts;
  explicit Renderer(std::unique_ptr<Parts> parts);
  void update(const World& world);
  void render(int width);

  std::unique_ptr<Parts> parts_;
};

}  // namespace engram::datasets::kitchen
