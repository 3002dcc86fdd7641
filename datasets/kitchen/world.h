// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the physics of the kitchen.

#include <mujoco/mujoco.h>

#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/kitchen/kitchen_layout.h"
#include "datasets/kitchen/model_text.h"
#include "datasets/kitchen/robot_body.h"
#include "ltm/core/status.h"

namespace engram::datasets::kitchen {

struct ModelDeleter {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
};
struct DataDeleter {
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using Model = std::unique_ptr<mjModel, ModelDeleter>;
using State = std::unique_ptr<mjData, DataDeleter>;

/// The wanted motion of the robot's joints. Unit: rad and m, per second, per second squared.
struct Motion {
  RobotVector position = RobotVector::Zero();
  RobotVector velocity = RobotVector::Zero();
  RobotVector acceleration = RobotVector::Zero();
};

[[nodiscard]] Pose pose_of(const mjData& data, int body);

/// The physics of the room, the robot and the things of one layout.
///
/// The robot follows a motion by computed torques, and no part of it collides. Things fall, rest on
/// furniture and on each other, and are held by a rigid link to a hand.
/// Threading: one thread.
class World {
 public:
  /// Errors: kUnavailable with MuJoCo's message if it rejects the model.
  static Result<World> create(const Layout& layout, const DrawingSize& size);

  /// Places the robot in a pose immediately, at rest.
  void place_robot(const RobotVector& pose);

  /// Advances by one time step, kStep_s.
  void step(const Motion& wanted);
  static constexpr double kStep_s = 0.002;

  /// Updates the poses of parts to the current state; step() does not update them.
  void refresh();

  [[nodiscard]] RobotVector positions() const;
  [[nodiscard]] RobotVector velocities() const;

  [[nodiscard]] Pose body_pose(const std::string& name) const;
  [[nodiscard]] Pose thing_pose(size_t thing) const;
  /// The chair or the person: an index of movable_classes(). The layout must have them.
  [[nodiscard]] Pose movable_pose(size_t movable) const;
  [[nodiscard]] Pose hand_pose(Side side) const;
  /// Frame: x right, y down, z forward.
  [[nodiscard]] Pose camera_pose(Side side) const;

  /// Fixes a thing to a hand in their current relative pose.
  void hold(Side side, size_t thing);
  void release(Side side);
  [[nodiscard]] std::optional<size_t> held(Side side) const { return held_[index(side)]; }

  /// Moves a thing, which then rests, or the chair or the person immediately. Poses of parts follow
  /// with the next step() or refresh().
  void place_thing(size_t thing, const Pose& at);
  void place_movable(size_t movable, const Pose& at);

  /// Returns a world of the same model, so that one can be drawn while the other moves.
  /// Errors: kResourceExhausted.
  [[nodiscard]] Result<World> twin() const;
  /// Where everything is. A twin that gets these looks the same.
  [[nodiscard]] std::vector<double> coordinates() const;
  void set_coordinates(const std::vector<double>& all);

  /// Returns true if nothing but the robot's arms is between the left camera and the middle of a
  /// thing.
  [[nodiscard]] bool is_in_sight(size_t thing) const;
  [[nodiscard]] bool is_movable_in_sight(size_t movable) const;

  /// The index in MuJoCo's vectors of a joint of a RobotVector, and the joint's range, which is
  /// unlimited for the platform.
  [[nodiscard]] int dof(int joint) const { return dofs_.at(static_cast<size_t>(joint)); }
  [[nodiscard]] std::pair<double, double> range(int joint) const;
  /// Writes the robot's coordinates to a state of the same model.
  void set_robot(const RobotVector& pose, mjData& state) const;

  [[nodiscard]] const mjModel& model() const { return *model_; }
  [[nodiscard]] mjData& data() const { return *data_; }
  [[nodiscard]] const Layout& layout() const { return layout_; }

 private:
  World() = default;

  static size_t index(Side side) { return side == Side::kLeft ? 0 : 1; }
  [[nodiscard]] int weld(Side side, size_t thing) const;
  [[nodiscard]] bool is_body_in_sight(int body) const;

  Layout layout_;
  Model model_;
  State data_;
  std::array<int, kRobotJoints> dofs_{};       ///< Indices of RobotVector in qvel and qpos.
  std::vector<int> bodies_;                    ///< The bodies of the things.
  std::vector<int> movables_;                  ///< The bodies of movable_classes().
  std::array<std::optional<size_t>, 2> held_;  ///< The thing in each hand, by side.
  std::vector<mjtNum> torques_;
  std::vector<mjtNum> accelerations_;
};

}  // namespace engram::datasets::kitchen
