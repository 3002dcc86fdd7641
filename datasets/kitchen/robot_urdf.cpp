// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/robot_urdf.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

namespace engram::datasets::kitchen {

namespace {

/// A billionth of a metre or radian is less than what MuJoCo's numbers say of a pose, and -0 would
/// be written with its sign.
double tidy(double number) {
  return std::round(number * 1e9) / 1e9 + 0.0;
}

std::string text_of(const Eigen::Vector3d& vector) {
  return fmt::format("{} {} {}", tidy(vector.x()), tidy(vector.y()), tidy(vector.z()));
}

/// Angles about the fixed axes x, y and z, one after the other, as URDF writes a rotation.
Eigen::Vector3d fixed_axis_angles(const Eigen::Matrix3d& turn) {
  const double level = std::hypot(turn(0, 0), turn(1, 0));
  const double pitch = std::atan2(-turn(2, 0), level);
  // Looking straight up or down, x and z turn about one axis, and one of their angles is free.
  constexpr double kUpright = 1e-9;
  if (level < kUpright) return {0, pitch, std::atan2(-turn(0, 1), turn(1, 1))};
  return {std::atan2(turn(2, 1), turn(2, 2)), pitch, std::atan2(turn(1, 0), turn(0, 0))};
}

Pose pose_from(const mjtNum* position, const mjtNum* quaternion) {
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(position[0], position[1], position[2]);
  pose.linear() = Eigen::Quaterniond(quaternion[0], quaternion[1], quaternion[2], quaternion[3])
                      .normalized()
                      .toRotationMatrix();
  return pose;
}

std::string origin_of(const Pose& pose) {
  return fmt::format(R"(<origin xyz="{}" rpy="{}"/>)", text_of(pose.translation()),
                     text_of(fixed_axis_angles(pose.linear())));
}

/// Writes the bodies of a model that a root carries.
class UrdfWriter {
 public:
  explicit UrdfWriter(const mjModel& model) : model_(model) {}

  std::string text() {
    const int root = mj_name2id(&model_, mjOBJ_BODY, "platform");
    // Bodies follow their parents in a model, and a part's parts follow it at once.
    std::vector<std::string> links(static_cast<size_t>(model_.nbody));
    for (int body = root; body < model_.nbody; ++body) {
      const std::string parent =
          body == root ? "" : links.at(static_cast<size_t>(model_.body_parentid[body]));
      if (body != root && parent.empty()) break;
      links.at(static_cast<size_t>(body)) =
          body == root ? name_of(mjOBJ_BODY, body) : add_joints(body, parent);
      add_link(links.at(static_cast<size_t>(body)), body);
      add_cameras(links.at(static_cast<size_t>(body)), body);
    }
    return fmt::format("<?xml version=\"1.0\"?>\n<robot name=\"humanoid\">\n{}{}</robot>\n",
                       materials(), text_);
  }

 private:
  std::string name_of(mjtObj type, int id) const {
    const char* name = mj_id2name(&model_, type, id);
    return name == nullptr ? "" : name;
  }

  /// Adds what leads from the parent's link to a body, and returns the name of the body's link.
  /// URDF has one joint between two links, so a body with more joints gets links without a shape.
  std::string add_joints(int body, const std::string& parent) {
    const Pose pose = pose_from(model_.body_pos + 3 * body, model_.body_quat + 4 * body);
    const int first = model_.body_jntadr[body];
    const int count = model_.body_jntnum[body];
    std::string name = name_of(mjOBJ_BODY, body);
    if (count == 0) {
      add_fixed(name, parent, pose);
      return name;
    }
    std::string link = parent;
    for (int i = 0; i < count; ++i) {
      const std::string joint = name_of(mjOBJ_JOINT, first + i);
      const bool is_last = i + 1 == count;
      const std::string child = is_last && !name.empty() ? name : joint + "_link";
      const mjtNum* axis = model_.jnt_axis + 3 * (first + i);
      const mjtNum* range = model_.jnt_range + 2 * (first + i);
      // URDF demands an effort and a velocity, which the simulation does not limit.
      text_ += fmt::format(
          R"(<joint name="{}" type="{}">{}<parent link="{}"/><child link="{}"/><axis xyz="{}"/>)"
          R"(<limit lower="{}" upper="{}" effort="0" velocity="0"/></joint>)"
          "\n",
          joint, model_.jnt_type[first + i] == mjJNT_SLIDE ? "prismatic" : "revolute",
          origin_of(i == 0 ? pose : Pose::Identity()), link, child,
          text_of({axis[0], axis[1], axis[2]}), tidy(range[0]), tidy(range[1]));
      if (!is_last) text_ += fmt::format("<link name=\"{}\"/>\n", child);
      link = child;
    }
    return link;
  }

  void add_fixed(const std::string& name, const std::string& parent, const Pose& pose) {
    text_ += fmt::format(
        R"(<joint name="{}_mount" type="fixed">{}<parent link="{}"/><child link="{}"/></joint>)"
        "\n",
        name, origin_of(pose), parent, name);
  }

  void add_link(const std::string& name, int body) {
    text_ += fmt::format("<link name=\"{}\">\n", name);
    for (int i = 0; i < model_.body_geomnum[body]; ++i) add_shape(model_.body_geomadr[body] + i);
    text_ += "</link>\n";
  }

  void add_cameras(const std::string& link, int body) {
    for (int camera = 0; camera < model_.ncam; ++camera) {
      if (model_.cam_bodyid[camera] != body) continue;
      Pose pose = pose_from(model_.cam_pos + 3 * camera, model_.cam_quat + 4 * camera);
      // MuJoCo's cameras have y up and look along -z.
      pose.linear() = pose.linear() * Eigen::Vector3d(1, -1, -1).asDiagonal();
      const std::string name = name_of(mjOBJ_CAMERA, camera) + "_camera";
      add_fixed(name, link, pose);
      text_ += fmt::format("<link name=\"{}\"/>\n", name);
    }
  }

  void add_visual(int geom, const Pose& pose, const std::string& shape) {
    text_ += fmt::format(R"(<visual>{}<geometry>{}</geometry><material name="{}"/></visual>)"
                         "\n",
                         origin_of(pose), shape, name_of(mjOBJ_MATERIAL, model_.geom_matid[geom]));
  }

  void add_sphere(int geom, const Pose& pose, double radius) {
    add_visual(geom, pose, fmt::format(R"(<sphere radius="{}"/>)", tidy(radius)));
  }

  /// MuJoCo's sizes are half edges, half lengths and radii.
  void add_shape(int geom) {
    const mjtNum* size = model_.geom_size + 3 * geom;
    const Pose pose = pose_from(model_.geom_pos + 3 * geom, model_.geom_quat + 4 * geom);
    switch (model_.geom_type[geom]) {
      case mjGEOM_BOX:
        return add_visual(
            geom, pose,
            fmt::format(R"(<box size="{}"/>)", text_of({2 * size[0], 2 * size[1], 2 * size[2]})));
      case mjGEOM_SPHERE:
        return add_sphere(geom, pose, size[0]);
      case mjGEOM_ELLIPSOID:
        // URDF has no ellipsoid; a sphere of the same volume comes closest.
        return add_sphere(geom, pose, std::cbrt(size[0] * size[1] * size[2]));
      default:
        break;
    }
    add_visual(
        geom, pose,
        fmt::format(R"(<cylinder radius="{}" length="{}"/>)", tidy(size[0]), tidy(2 * size[1])));
    if (model_.geom_type[geom] != mjGEOM_CAPSULE) return;
    for (const double end : {-size[1], size[1]})
      add_sphere(geom, pose * Eigen::Translation3d(0, 0, end), size[0]);
  }

  /// The colours that the robot's shapes name.
  std::string materials() const {
    std::vector<bool> is_used(static_cast<size_t>(model_.nmat));
    std::string text;
    for (int geom = 0; geom < model_.ngeom; ++geom) {
      const int material = model_.geom_matid[geom];
      const std::string name = material < 0 ? "" : name_of(mjOBJ_MATERIAL, material);
      if (name.empty() || is_used.at(static_cast<size_t>(material))) continue;
      if (text_.find("<material name=\"" + name + "\"/>") == std::string::npos) continue;
      is_used.at(static_cast<size_t>(material)) = true;
      const float* colour = model_.mat_rgba + 4 * material;
      text += fmt::format("<material name=\"{}\"><color rgba=\"{} {} {} {}\"/></material>\n", name,
                          colour[0], colour[1], colour[2], colour[3]);
    }
    return text;
  }

  const mjModel& model_;
  std::string text_;
};

}  // namespace

std::string robot_urdf(const World& world) {
  return UrdfWriter(world.model()).text();
}

}  // namespace engram::datasets::kitchen
