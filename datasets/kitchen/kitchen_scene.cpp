// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/kitchen_scene.h"

#include <algorithm>
#include <optional>

#include "datasets/kitchen/entities.h"
#include "datasets/kitchen/kitchen_types.h"
#include "datasets/kitchen/world.h"

namespace engram::datasets {

namespace {

using augmentation::LampKind;
using augmentation::PartPose;
using augmentation::Scene;
using augmentation::SceneShape;
using augmentation::ShapeKind;
using augmentation::TextureWay;

/// MuJoCo draws geoms of the first groups; the other groups are for collisions.
constexpr int kDrawnGroups = 3;

/// Strengths of Blender's lamps for a diffuse light of 1 in MuJoCo, fitted to recorded images.
constexpr double kLamp_W = 16;
constexpr double kWindow_W_m2 = 3.6;

PartPose to_part(const Eigen::Isometry3d& pose) {
  PartPose part{};
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      part.at(static_cast<size_t>(4 * row + column)) = pose.matrix()(row, column);
  return part;
}

PartPose at(double x, double y, double z) {
  return to_part(Eigen::Isometry3d(Eigen::Translation3d(x, y, z)));
}

Eigen::Isometry3d pose_of_geom(const mjData& data, int geom) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int row = 0; row < 3; ++row) {
    pose.translation()[row] = data.geom_xpos[3 * geom + row];
    for (int column = 0; column < 3; ++column)
      pose.linear()(row, column) = data.geom_xmat[9 * geom + 3 * row + column];
  }
  return pose;
}

/// Sets the kind and half sizes; returns false if the geom is not a solid.
bool set_form(const mjModel& model, int geom, SceneShape& shape) {
  const mjtNum* size = model.geom_size + 3 * geom;
  switch (model.geom_type[geom]) {
    case mjGEOM_PLANE:
      shape.kind = ShapeKind::kBox;
      shape.half = {size[0], size[1], 1e-4};
      return size[0] > 0 && size[1] > 0;
    case mjGEOM_BOX:
      shape.kind = ShapeKind::kBox;
      shape.half = {size[0], size[1], size[2]};
      return true;
    case mjGEOM_SPHERE:
      shape.kind = ShapeKind::kEllipsoid;
      shape.half = {size[0], size[0], size[0]};
      return true;
    case mjGEOM_ELLIPSOID:
      shape.kind = ShapeKind::kEllipsoid;
      shape.half = {size[0], size[1], size[2]};
      return true;
    case mjGEOM_CYLINDER:
      shape.kind = ShapeKind::kCylinder;
      shape.half = {size[0], size[0], size[1]};
      return true;
    case mjGEOM_CAPSULE:
      shape.kind = ShapeKind::kCapsule;
      shape.half = {size[0], size[0], size[1] + size[0]};
      return true;
    default:
      return false;
  }
}

void set_look(const mjModel& model, int geom, SceneShape& shape) {
  const float* colour = model.geom_rgba + 4 * geom;
  if (const int material = model.geom_matid[geom]; material >= 0) {
    colour = model.mat_rgba + 4 * material;
    shape.texture = model.mat_texid[material];
    shape.repeat = {model.mat_texrepeat[2 * material], model.mat_texrepeat[2 * material + 1]};
    shape.roughness = 1 - 0.7 * model.mat_shininess[material];
    shape.emission = model.mat_emission[material];
    if (shape.texture >= 0 && model.tex_type[shape.texture] == mjTEXTURE_CUBE)
      shape.way = TextureWay::kCube;
  }
  shape.colour = {colour[0], colour[1], colour[2]};
}

void add_lamps(const kitchen::Lighting& light, Scene& scene) {
  const std::array<double, 3> warm{1, 1 - 0.04 * light.warmth, 1 - 0.14 * light.warmth};
  scene.lamps.push_back({LampKind::kPoint, at(light.lamp_x_m, light.lamp_y_m, 2.5),
                         kLamp_W * light.lamp, 0.12, warm, true, false});
  // Light from the window passes through the walls and casts no shadows, as in the recording.
  const Eigen::Isometry3d window(Eigen::Quaterniond::FromTwoVectors(
      -Eigen::Vector3d::UnitZ(), Eigen::Vector3d(0.15, -0.7, -0.7)));
  scene.lamps.push_back(
      {LampKind::kSun, to_part(window), kWindow_W_m2 * light.daylight, 0, {0.92, 0.96, 1}, false});
  const double ambient = std::min(1.0, 0.68 + 0.20 * light.daylight);
  scene.ambient = {ambient, ambient, ambient * (1 - 0.12 * light.warmth)};
}

template <typename Value>
Result<Value> value_of(const char* name, const idf::Data& data) {
  auto value = Value::from_idf(data);
  if (!value.ok()) return value.status().with_context(fmt::format("kitchen moment: {}", name));
  return value;
}

}  // namespace

struct KitchenScenes::State {
  std::optional<kitchen::World> world;

  /// Loads the kitchen of a recording, with everything at its initial place.
  Status load(const idf::Data& data) {
    ENGRAM_ASSIGN_OR_RETURN(const auto recording,
                            value_of<::kitchen::Recording>("recording", data));
    const auto seed = static_cast<uint64_t>(recording.seed);
    if (world && world->layout().seed == seed) return {};
    ENGRAM_ASSIGN_OR_RETURN(world,
                            kitchen::World::create(kitchen::make_layout(seed), {64, 64, 0, 0}));
    return {};
  }

  Status place_robot(const KitchenMoment& moment) {
    ENGRAM_ASSIGN_OR_RETURN(const auto joints,
                            value_of<::kitchen::JointState>("joints", moment.joints));
    ENGRAM_ASSIGN_OR_RETURN(const auto platform,
                            value_of<::kitchen::PlatformState>("platform", moment.platform));
    kitchen::RobotVector robot;
    for (int i = 0; i < kitchen::kPlatformJoints; ++i)
      robot[i] = platform.pose_world_platform.values<float>()[static_cast<size_t>(i)];
    for (int i = 0; i < kitchen::kJoints; ++i)
      robot[kitchen::kPlatformJoints + i] =
          joints.positions.values<float>()[static_cast<size_t>(i)];
    world->set_robot(robot, world->data());
    return {};
  }

  Status place_thing(const ltm::MemoryId& entity, const idf::Data& data) {
    ENGRAM_ASSIGN_OR_RETURN(const auto object, value_of<::kitchen::ObjectInstance>("object", data));
    for (const kitchen::Thing& thing : world->layout().things) {
      if (kitchen::entities::object(*thing.type) != entity) continue;
      const std::string name(thing.type->name);
      const int joint = mj_name2id(&world->model(), mjOBJ_JOINT, name.c_str());
      ENGRAM_CHECK(joint >= 0, "no joint '{}'", name);
      mjtNum* to = world->data().qpos + world->model().jnt_qposadr[joint];
      const auto& pose = object.pose_world_object;
      const Eigen::Quaterniond turn = pose.orientation.normalized();
      for (int i = 0; i < 3; ++i) to[i] = pose.position[i];
      to[3] = turn.w();
      to[4] = turn.x();
      to[5] = turn.y();
      to[6] = turn.z();
      return {};
    }
    return invalid_argument(
        "kitchen moment: found object '{}', which the kitchen of seed {} has not",
        entity.to_string(), world->layout().seed);
  }

  [[nodiscard]] std::string thing_of(int geom) const {
    const int body = world->model().geom_bodyid[geom];
    const char* name = mj_id2name(&world->model(), mjOBJ_BODY, body);
    if (name == nullptr) return {};
    for (const kitchen::Thing& thing : world->layout().things)
      if (thing.type->name == name)
        return std::string(kitchen::entities::object(*thing.type).names().back());
    return {};
  }

  void add_shapes(Scene& scene) const {
    const mjModel& model = world->model();
    for (int i = 0; i < model.ntex; ++i) {
      const int width = model.tex_width[i];
      const int height = model.tex_height[i];
      const mjtByte* pixels = model.tex_rgb + model.tex_adr[i];
      scene.textures.push_back(idf::NdArray::take<uint8_t>(
          {height, width, 3}, {pixels, pixels + static_cast<ptrdiff_t>(3) * width * height}));
    }
    for (int geom = 0; geom < model.ngeom; ++geom) {
      SceneShape shape;
      if (model.geom_group[geom] >= kDrawnGroups || !set_form(model, geom, shape)) continue;
      shape.thing = thing_of(geom);
      // The camera may be moved, so the head that carried it must not block its view.
      shape.is_seen = model.geom_bodyid[geom] != model.cam_bodyid[0];
      shape.pose = to_part(pose_of_geom(world->data(), geom));
      set_look(model, geom, shape);
      scene.shapes.push_back(std::move(shape));
    }
  }
};

KitchenScenes::KitchenScenes() : state_(std::make_unique<State>()) {}
KitchenScenes::~KitchenScenes() = default;

Result<augmentation::Scene> KitchenScenes::scene(const KitchenMoment& moment) {
  ENGRAM_RETURN_IF_ERROR(state_->load(moment.recording));
  ENGRAM_ASSIGN_OR_RETURN(
      const auto camera, value_of<::kitchen::CameraCalibration>("calibration", moment.calibration));
  ENGRAM_ASSIGN_OR_RETURN(const auto view, value_of<::kitchen::View>("view", moment.view));
  ENGRAM_RETURN_IF_ERROR(state_->place_robot(moment));
  for (const auto& [entity, value] : moment.objects)
    ENGRAM_RETURN_IF_ERROR(state_->place_thing(entity, value));
  state_->world->refresh();
  Scene scene;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = view.pose_world_camera.position;
  pose.linear() = view.pose_world_camera.orientation.normalized().toRotationMatrix();
  scene.camera = {camera.width, camera.height, camera.fx,    camera.fy,
                  camera.cx,    camera.cy,     to_part(pose)};
  state_->add_shapes(scene);
  add_lamps(state_->world->layout().light, scene);
  return scene;
}

}  // namespace engram::datasets
