// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/idf/ndarray.h"

namespace engram::augmentation {

/// Transforms coordinates of a part to world coordinates: the rows of a 4 x 4 matrix. Unit of its
/// last column: m.
using PartPose = std::array<double, 16>;

/// A pinhole camera without distortion: u = fx x / z + cx, where (0, 0) is the middle of the top
/// left pixel. Frame: x right, y down, z forward. Unit: pixels.
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
  kCylinder,  ///< Its axis is z.
  kCapsule,   ///< Its axis is z; `half` includes the caps.
  kEllipsoid,
};

/// How a picture lies on a shape.
enum class TextureWay {
  kPlane,  ///< In the x-y plane of the shape, repeated `repeat` times over its extent.
  kCube,   ///< Six faces stacked vertically: +x, -x, +y, -y, +z, -z, seen from the middle.
};

/// A solid with one colour or one picture.
struct SceneShape {
  std::string thing;  ///< The object that it belongs to; empty for the room.
  ShapeKind kind = ShapeKind::kBox;
  std::array<double, 3> half{};  ///< Half of its extents along x, y and z. Unit: m.
  PartPose pose{};
  /// sRGB, 0 to 1. A picture is multiplied by it.
  std::array<double, 3> colour{0.8, 0.8, 0.8};
  int texture = -1;  ///< Index into Scene::textures; negative for none.
  TextureWay way = TextureWay::kPlane;
  std::array<double, 2> repeat{1, 1};
  double roughness = 0.6;  ///< From 0, a mirror, to 1, dull.
  double emission = 0;     ///< Light that the shape emits, as a factor of its colour.
  bool is_seen = true;     ///< If false, the camera does not see it, but it still casts shadows.
};

enum class LampKind {
  kPoint,  ///< Shines to all sides. Unit of `strength`: W.
  kSun,    ///< Shines along -z of its pose. Unit of `strength`: W / m^2.
};

struct SceneLamp {
  LampKind kind = LampKind::kPoint;
  PartPose pose{};
  double strength = 100;
  /// Radius of a point in m, or angle of a sun in rad. Larger lamps have softer shadows.
  double size = 0.3;
  std::array<double, 3> colour{1, 1, 1};
  bool casts_shadow = true;
  /// If false, a point lights everything as it lights what is 1 m away, as simulators do.
  bool falls_off = true;
};

/// What one camera can see at one moment.
struct Scene {
  SceneCamera camera;
  std::vector<SceneShape> shapes;
  std::vector<SceneLamp> lamps;
  /// The light that comes from everywhere and that nothing shades: the sRGB colour of a white
  /// surface in it.
  std::array<double, 3> ambient{0.3, 0.3, 0.3};
  /// Shape: uint8 [height, width, 3], RGB.
  std::vector<idf::NdArray> textures;

  /// Errors: kInvalidArgument naming the part, what was found and what was needed.
  [[nodiscard]] Status validate() const;
};

/// Gives all parts of a thing this colour. Pictures on it are multiplied by the colour.
/// Errors: kNotFound if the scene has no such thing.
Status recolour(Scene& scene, const std::string& thing, const std::array<double, 3>& colour);

/// Replaces `thing` by the parts of `other`, a thing of the same or another scene. The new parts
/// are placed so that the undersides, and the middles seen from above, coincide.
/// Errors: kNotFound if there is no thing of either name.
Status replace(Scene& scene, const std::string& thing, const Scene& from, const std::string& other);

}  // namespace engram::augmentation
