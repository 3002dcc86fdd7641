// SPDX-License-Identifier: Apache-2.0
#include "augmentation/blender/scene.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace engram::augmentation {

namespace {

bool is_finite(std::span<const double> values) {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

bool is_pose(const PartPose& pose) {
  return is_finite(pose) && pose[12] == 0 && pose[13] == 0 && pose[14] == 0 && pose[15] == 1;
}

std::string name_of(const SceneShape& shape) {
  return shape.thing.empty() ? "the room" : "'" + shape.thing + "'";
}

Status check(const SceneShape& shape, size_t textures) {
  const std::string name = name_of(shape);
  if (!is_finite(shape.half) || std::ranges::any_of(shape.half, [](double h) { return h <= 0; }))
    return invalid_argument(
        "scene: a shape of {}: found half sizes {} x {} x {} m, needs more "
        "than zero",
        name, shape.half[0], shape.half[1], shape.half[2]);
  if (!is_pose(shape.pose))
    return invalid_argument("scene: a shape of {}: its pose is no pose", name);
  if (shape.texture >= static_cast<int>(textures))
    return invalid_argument("scene: a shape of {}: found texture {} of {}", name, shape.texture,
                            textures);
  if (!is_finite(shape.colour) || !is_finite(shape.repeat) || !std::isfinite(shape.roughness) ||
      !std::isfinite(shape.emission))
    return invalid_argument("scene: a shape of {}: found a colour that is not finite", name);
  return {};
}

/// The middle of a thing seen from above, and the height of its underside. Frame: world.
struct Place {
  double x = 0;
  double y = 0;
  double bottom = 0;
};

Result<Place> place_of(const Scene& scene, const std::string& thing) {
  std::array<double, 3> low{1e300, 1e300, 1e300};
  std::array<double, 3> high{-1e300, -1e300, -1e300};
  for (const SceneShape& shape : scene.shapes) {
    if (shape.thing != thing) continue;
    for (size_t row = 0; row < 3; ++row) {
      double reach = 0;
      for (size_t column = 0; column < 3; ++column)
        reach += std::abs(shape.pose[4 * row + column]) * shape.half[column];
      const double middle = shape.pose[4 * row + 3];
      low[row] = std::min(low[row], middle - reach);
      high[row] = std::max(high[row], middle + reach);
    }
  }
  if (low[0] > high[0]) return not_found("scene: has no thing '{}'", thing);
  return Place{0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), low[2]};
}

}  // namespace

Status Scene::validate() const {
  if (camera.width < 8 || camera.height < 8 || camera.width > 4096 || camera.height > 4096)
    return invalid_argument("scene: found an image of {} x {} pixels, needs 8 to 4096",
                            camera.width, camera.height);
  if (!(camera.fx > 0) || !(camera.fy > 0) || !std::isfinite(camera.cx) ||
      !std::isfinite(camera.cy) || !is_pose(camera.pose))
    return invalid_argument(
        "scene: camera: found focal lengths {} and {} pixels, needs more than zero, and a pose",
        camera.fx, camera.fy);
  for (const SceneShape& shape : shapes) ENGRAM_RETURN_IF_ERROR(check(shape, textures.size()));
  for (const SceneLamp& lamp : lamps)
    if (!is_pose(lamp.pose) || !(lamp.strength >= 0) || !(lamp.size >= 0))
      return invalid_argument("scene: a lamp: found strength {} and size {}, needs 0 or more",
                              lamp.strength, lamp.size);
  for (size_t i = 0; i < textures.size(); ++i) {
    const idf::NdArray& picture = textures[i];
    if (picture.type() != idf::ElementType::kUInt8 || picture.shape().size() != 3 ||
        picture.shape()[2] != 3)
      return invalid_argument("scene: texture {}: found {} {}, needs uint8 [height, width, 3]", i,
                              idf::to_string(picture.type()), idf::to_string(picture.shape()));
  }
  return {};
}

Status recolour(Scene& scene, const std::string& thing, const std::array<double, 3>& colour) {
  bool is_there = false;
  for (SceneShape& shape : scene.shapes) {
    if (shape.thing != thing) continue;
    shape.colour = colour;
    is_there = true;
  }
  return is_there ? Status() : not_found("scene: has no thing '{}'", thing);
}

Status replace(Scene& scene, const std::string& thing, const Scene& from,
               const std::string& other) {
  ENGRAM_ASSIGN_OR_RETURN(const Place to, place_of(scene, thing));
  ENGRAM_ASSIGN_OR_RETURN(const Place at, place_of(from, other));
  std::vector<SceneShape> parts;
  const auto textures = static_cast<int>(scene.textures.size());
  const bool is_same = &scene == &from;
  for (SceneShape part : from.shapes) {
    if (part.thing != other) continue;
    part.thing = thing;
    part.pose[3] += to.x - at.x;
    part.pose[7] += to.y - at.y;
    part.pose[11] += to.bottom - at.bottom;
    if (part.texture >= 0 && !is_same) part.texture += textures;
    parts.push_back(part);
  }
  // `from` may be the scene itself, so its parts and textures are copied before it is changed.
  const std::vector<idf::NdArray> added = is_same ? std::vector<idf::NdArray>() : from.textures;
  std::erase_if(scene.shapes, [&](const SceneShape& shape) { return shape.thing == thing; });
  scene.shapes.insert(scene.shapes.end(), parts.begin(), parts.end());
  scene.textures.insert(scene.textures.end(), added.begin(), added.end());
  return {};
}

}  // namespace engram::augmentation
