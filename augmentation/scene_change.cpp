// SPDX-License-Identifier: Apache-2.0
#include "augmentation/scene_change.h"

#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace engram::augmentation {

namespace {

using RowMajorPose = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

constexpr std::string_view kPrefix = "scene_";
/// Bounds at full strength.
constexpr int64_t kMaxShift_mm = 200;
constexpr int64_t kMaxTurn_mdeg = 12'000;
constexpr int64_t kMaxLampShift_mm = 800;
constexpr int64_t kMaxPercent = 60;

Eigen::Isometry3d to_isometry(const PartPose& pose) {
  return Eigen::Isometry3d(Eigen::Map<const RowMajorPose>(pose.data()).eval());
}

PartPose to_part(const Eigen::Isometry3d& pose) {
  PartPose part{};
  Eigen::Map<RowMajorPose>(part.data()) = pose.matrix();
  return part;
}

int64_t within(Random& random, int64_t max, int strength_percent) {
  const int64_t reach = max * strength_percent / 100;
  return random.between(-reach, reach);
}

/// Returns all things of a scene in an order that depends only on `random` and on their names.
std::vector<std::string> shuffled_things(const Scene& scene, Random& random) {
  // All things are shuffled, not only those in sight: as long as the same thing is the first one in
  // sight, neighbouring snapshots change the same thing.
  std::set<std::string> names;
  for (const SceneShape& shape : scene.shapes)
    if (!shape.thing.empty()) names.insert(shape.thing);
  std::vector<std::string> things(names.begin(), names.end());
  for (size_t i = things.size(); i > 1; --i)
    std::swap(things[i - 1],
              things[static_cast<size_t>(random.between(0, static_cast<int64_t>(i) - 1))]);
  return things;
}

/// Returns the things to change, starting with the first one that is in sight. The result is empty
/// if none is in sight.
std::vector<std::string> changed_first(const Scene& scene, const std::vector<std::string>& in_sight,
                                       Random& random) {
  std::vector<std::string> things = shuffled_things(scene, random);
  const auto first = std::ranges::find_if(things, [&](const std::string& thing) {
    return std::ranges::find(in_sight, thing) != in_sight.end();
  });
  if (first == things.end()) return {};
  std::rotate(things.begin(), first, first + 1);
  return things;
}

idf::Dict draw_colour(Random& random) {
  // One channel is nearly full, one is nearly empty and one is drawn, which gives all hues.
  std::array<int64_t, 3> levels{235, 25, random.between(25, 235)};
  for (size_t i = 2; i > 0; --i)
    std::swap(levels[i], levels[static_cast<size_t>(random.between(0, static_cast<int64_t>(i)))]);
  return {{"red", levels[0]}, {"green", levels[1]}, {"blue", levels[2]}};
}

idf::Dict draw_view(int strength_percent, Random& random) {
  idf::Dict drawn;
  for (const char* name : {"right_mm", "down_mm", "forward_mm"})
    drawn.set(name, within(random, kMaxShift_mm, strength_percent));
  for (const char* name : {"up_millidegrees", "right_millidegrees", "roll_millidegrees"})
    drawn.set(name, within(random, kMaxTurn_mdeg, strength_percent));
  return drawn;
}

idf::Dict draw_light(int strength_percent, Random& random) {
  return {{"lamps_percent", 100 + within(random, kMaxPercent, strength_percent)},
          {"ambient_percent", 100 + within(random, kMaxPercent / 2, strength_percent)},
          {"warmth_percent", within(random, 100, strength_percent)},
          {"lamps_x_mm", within(random, kMaxLampShift_mm, strength_percent)},
          {"lamps_y_mm", within(random, kMaxLampShift_mm, strength_percent)}};
}

Result<std::string> text_of(const Change& change, std::string_view parameter) {
  const idf::Data* value = change.parameters.find(parameter);
  if (value == nullptr || !value->is<std::string>())
    return invalid_argument("recipe: change '{}': '{}' needs a text", change.name, parameter);
  return value->get<std::string>();
}

/// Reads a whole number and checks its bounds.
Result<double> number_of(const Change& change, std::string_view parameter, int64_t min,
                         int64_t max) {
  ENGRAM_ASSIGN_OR_RETURN(const int64_t value, change.integer(parameter));
  if (value < min || value > max)
    return invalid_argument("recipe: change '{}': '{}' is {}, needs {} to {}", change.name,
                            parameter, value, min, max);
  return static_cast<double>(value);
}

Status recolour(Scene& scene, const Change& change) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string thing, text_of(change, "thing"));
  ENGRAM_ASSIGN_OR_RETURN(const double red, number_of(change, "red", 0, 255));
  ENGRAM_ASSIGN_OR_RETURN(const double green, number_of(change, "green", 0, 255));
  ENGRAM_ASSIGN_OR_RETURN(const double blue, number_of(change, "blue", 0, 255));
  return recolour(scene, thing, {red / 255, green / 255, blue / 255});
}

Status replace(Scene& scene, const Change& change) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string thing, text_of(change, "thing"));
  ENGRAM_ASSIGN_OR_RETURN(const std::string other, text_of(change, "by"));
  return replace(scene, thing, scene, other);
}

Status move_camera(Scene& scene, const Change& change, const PartPose& rig) {
  constexpr int64_t kFar_mm = 100'000;
  constexpr int64_t kTurn_mdeg = 180'000;
  Eigen::Vector3d shift;
  Eigen::Vector3d turn;
  ENGRAM_ASSIGN_OR_RETURN(shift.x(), number_of(change, "right_mm", -kFar_mm, kFar_mm));
  ENGRAM_ASSIGN_OR_RETURN(shift.y(), number_of(change, "down_mm", -kFar_mm, kFar_mm));
  ENGRAM_ASSIGN_OR_RETURN(shift.z(), number_of(change, "forward_mm", -kFar_mm, kFar_mm));
  ENGRAM_ASSIGN_OR_RETURN(turn.x(), number_of(change, "up_millidegrees", -kTurn_mdeg, kTurn_mdeg));
  ENGRAM_ASSIGN_OR_RETURN(turn.y(),
                          number_of(change, "right_millidegrees", -kTurn_mdeg, kTurn_mdeg));
  ENGRAM_ASSIGN_OR_RETURN(turn.z(),
                          number_of(change, "roll_millidegrees", -kTurn_mdeg, kTurn_mdeg));
  turn *= std::numbers::pi / 180'000;
  Eigen::Isometry3d moved(Eigen::Translation3d(shift / 1000));
  if (turn.norm() > 0) moved.rotate(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  const Eigen::Isometry3d from = to_isometry(rig);
  // The motion is expressed in the frame of the rig, so both eyes of a stereo pair move as one.
  scene.camera.pose = to_part(from * moved * from.inverse() * to_isometry(scene.camera.pose));
  return {};
}

Status relight(Scene& scene, const Change& change) {
  ENGRAM_ASSIGN_OR_RETURN(const double lamps, number_of(change, "lamps_percent", 0, 1000));
  ENGRAM_ASSIGN_OR_RETURN(const double ambient, number_of(change, "ambient_percent", 0, 1000));
  ENGRAM_ASSIGN_OR_RETURN(const double warmth, number_of(change, "warmth_percent", -100, 100));
  ENGRAM_ASSIGN_OR_RETURN(const double x, number_of(change, "lamps_x_mm", -100'000, 100'000));
  ENGRAM_ASSIGN_OR_RETURN(const double y, number_of(change, "lamps_y_mm", -100'000, 100'000));
  // At most, red gains a quarter and blue loses a quarter.
  const std::array<double, 3> tint{1 + 0.0025 * warmth, 1, 1 - 0.0025 * warmth};
  for (SceneLamp& lamp : scene.lamps) {
    lamp.strength *= lamps / 100;
    for (size_t c = 0; c < 3; ++c) lamp.colour[c] *= tint[c];
    if (lamp.kind != LampKind::kPoint) continue;
    lamp.pose[3] += x / 1000;
    lamp.pose[7] += y / 1000;
  }
  for (size_t c = 0; c < 3; ++c)
    scene.ambient[c] = std::min(1.0, scene.ambient[c] * ambient / 100 * tint[c]);
  return {};
}

}  // namespace

const std::vector<SceneChangeKind>& all_scene_changes() {
  static const std::vector<SceneChangeKind> kinds{
      SceneChangeKind::kOriginal, SceneChangeKind::kRecolour, SceneChangeKind::kReplace,
      SceneChangeKind::kView, SceneChangeKind::kLight};
  return kinds;
}

const char* to_string(SceneChangeKind kind) {
  switch (kind) {
    case SceneChangeKind::kOriginal:
      return "original";
    case SceneChangeKind::kRecolour:
      return "recolour";
    case SceneChangeKind::kReplace:
      return "replace";
    case SceneChangeKind::kView:
      return "view";
    case SceneChangeKind::kLight:
      return "light";
  }
  return "";
}

Result<SceneChangeKind> parse_scene_change(std::string_view text) {
  std::vector<std::string_view> names;
  for (const SceneChangeKind kind : all_scene_changes()) {
    if (text == to_string(kind)) return kind;
    names.emplace_back(to_string(kind));
  }
  return invalid_argument("'{}' is no change of a scene, needs one of {}", text,
                          fmt::join(names, ", "));
}

std::optional<Change> draw_scene_change(SceneChangeKind kind, const Scene& scene,
                                        const std::vector<std::string>& things_in_sight,
                                        int strength_percent, Random& random) {
  Change change{std::string(kPrefix) + to_string(kind), {}};
  const auto needs_things = [&](size_t count) -> std::vector<std::string> {
    std::vector<std::string> things = changed_first(scene, things_in_sight, random);
    if (things.size() < count) things.clear();
    return things;
  };
  switch (kind) {
    case SceneChangeKind::kOriginal:
      break;
    case SceneChangeKind::kRecolour: {
      const auto things = needs_things(1);
      if (things.empty()) return std::nullopt;
      change.parameters = draw_colour(random);
      change.parameters.set("thing", things[0]);
      break;
    }
    case SceneChangeKind::kReplace: {
      const auto things = needs_things(2);
      if (things.empty()) return std::nullopt;
      change.parameters = {{"thing", things[0]}, {"by", things[1]}};
      break;
    }
    case SceneChangeKind::kView:
      change.parameters = draw_view(strength_percent, random);
      break;
    case SceneChangeKind::kLight:
      change.parameters = draw_light(strength_percent, random);
      break;
  }
  return change;
}

Status change_scene(Scene& scene, const Change& change, const PartPose& rig) {
  const std::string_view name = change.name;
  if (!name.starts_with(kPrefix))
    return invalid_argument("recipe: change '{}' is none of scenes", name);
  ENGRAM_ASSIGN_OR_RETURN(const SceneChangeKind kind,
                          parse_scene_change(name.substr(kPrefix.size())));
  switch (kind) {
    case SceneChangeKind::kOriginal:
      return {};
    case SceneChangeKind::kRecolour:
      return recolour(scene, change);
    case SceneChangeKind::kReplace:
      return replace(scene, change);
    case SceneChangeKind::kView:
      return move_camera(scene, change, rig);
    case SceneChangeKind::kLight:
      return relight(scene, change);
  }
  return {};
}

SceneCamera scaled_down(const SceneCamera& camera, int width) {
  if (width >= camera.width) return camera;
  SceneCamera scaled = camera;
  scaled.width = width;
  scaled.height = std::max(
      1, static_cast<int>(std::lround(static_cast<double>(camera.height) * width / camera.width)));
  const double x = static_cast<double>(scaled.width) / camera.width;
  const double y = static_cast<double>(scaled.height) / camera.height;
  scaled.fx *= x;
  scaled.fy *= y;
  // Coordinates count from the middle of the first pixel, so its border is half a pixel before.
  scaled.cx = (camera.cx + 0.5) * x - 0.5;
  scaled.cy = (camera.cy + 0.5) * y - 0.5;
  return scaled;
}

}  // namespace engram::augmentation
