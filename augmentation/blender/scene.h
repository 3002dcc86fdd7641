// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/idf/ndarray.h"

namespace engram::augmentation {

/// Takes coordinates of a part to world: rows of a 4 x 4 matrix. Unit of its last column: m.
using PartPose = std::array<double, 16>;

/// A pinhole without distortion: u = fx x / z + cx, where the middle of the pixel at the top left
/// is (0, 0). Frame: x right, y down, z forward. Unit: pixels.
struct SceneCamera {
  int width = 320;
  int height = 240;
  double fx = 0;
  double fy = 0;
  double cx = 0;
  double cy = 0;
  PartPose pose{};
};

enum class ShapeKind {
  kBox,
  kCylinder,  ///< Along z.
  kCapsule,   ///< Along z; `half` includes its caps.
  kEllipsoid,
};

/// How a picture lies on a shape.
enum class TextureWay {
  kPlane,  ///< Along x and y of the shape, repeated so often over its extent.
  kCube,   ///< Six faces, one below the other: +x, -x, +y, -y, +z, -z, seen from the middle.
};

/// One solid of one colour or picture.
struct SceneShape {
  std::string thing;  ///< The object that it is a part of; empty: the room.
  ShapeKind kind = ShapeKind::kBox;
  std::array<double, 3> half{};  ///< Of its extents along x, y, z. Unit: m.
  PartPose pose{};
  std::array<double, 3> colour{0.8, 0.8, 0.8};  ///< sRGB, 0 to 1; what a picture is multiplied by.
  int texture = -1;                             ///< Index into Scene::textures.
  TextureWay way = TextureWay::kPlane;
  std::array<double, 2> repeat{1, 1};
  double roughness = 0.6;  ///< 0: a mirror, 1: dull.
  double emission = 0;     ///< Light of its own, times its colour.
  bool is_seen = true;     ///< By the camera; it casts shadows all the same.
};

enum class LampKind {
  kPoint,  ///< `strength` in W, to all sides.
  kSun,    ///< `strength` in W / m^2, along -z of its pose.
};

struct SceneLamp {
  LampKind kind = LampKind::kPoint;
  PartPose pose{};
  double strength = 100;
  double size = 0.3;  ///< Radius in m, or angle in rad of a sun: larger ones have softer shadows.
  std::array<double, 3> colour{1, 1, 1};
  bool casts_shadow = true;
  /// False: a point lights everything as it lights what is 1 m away, as simulators' lights do.
  bool falls_off = true;
};

/// What is to be seen at one moment, by one camera.
struct Scene {
  SceneCamera camera;
  std::vector<SceneShape> shapes;
  std::vector<SceneLamp> lamps;
  /// sRGB of a white surface in the light from everywhere, which nothing shades.
  std::array<double, 3> ambient{0.3, 0.3, 0.3};
  /// Shape: uint8 [height, width, 3], RGB.
  std::vector<idf::NdArray> textures;

  /// Errors: kInvalidArgument naming the part, what was found and what was needed.
  [[nodiscard]] Status validate() const;
};

/// Makes all parts of a thing so coloured; pictures on it are multiplied by it.
/// Errors: kNotFound where the scene has no such thing.
Status recolour(Scene& scene, const std::string& thing, const std::array<double, 3>& colour);

/// Puts the parts of `other`, a thing of the same scene or of another one, in the place of `thing`:
/// undersides meet, and so do their middles seen from above.
/// Errors: kNotFound where there is none of that name.
Status replace(Scene& scene, const std::string& thing, const Scene& from, const std::string& other);

}  // namespace engram::augmentation
