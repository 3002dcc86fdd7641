// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the robot's body and its room, advanced sample by sample.

#include <string>
#include <vector>

#include "datasets/kitchen/kinematics.h"
#include "datasets/kitchen/kitchen.h"
#include "datasets/kitchen/platform_drive.h"
#include "datasets/kitchen/robot_bus.h"
#include "datasets/kitchen/trajectory.h"

namespace engram::datasets::kitchen {

/// Moves the world by what the robot was commanded, and says what it senses.
///
/// It knows no clock: whoever calls advance() decides when time passes. Equal calls give equal
/// states.
/// Threading: one thread.
class Body {
 public:
  /// Errors: those of World::create.
  static Result<Body> create(const KitchenOptions& options, const DrawingSize& size);

  /// Lets one sample, 10 ms, pass.
  void advance();

  [[nodiscard]] uint64_t sample() const { return sample_; }
  /// Call it once for each sample: news are told once.
  [[nodiscard]] BodyState sense();

  /// See RobotBus.
  Result<double> command(const BodyCommand& command);
  Result<std::string> poke(const std::string& what);

  [[nodiscard]] const World& world() const { return *world_; }

 private:
  /// The target that the cameras follow.
  struct Gaze {
    std::optional<size_t> thing;
    std::optional<size_t> movable;
    Eigen::Vector3d point{0, 0, 0};
  };

  Body(World world, const DrawingSize& size);

  [[nodiscard]] double now_s() const;
  void follow();
  /// Stops the platform before the chair or the person.
  void keep_clear();
  /// Brings the platform to rest, whatever moves it.
  void brake();
  /// The movable that the platform gets too close to at this velocity (frame: world); empty: none.
  [[nodiscard]] std::string_view in_the_way(const Eigen::Vector2d& velocity) const;
  /// The index of a thing or, after those, of a movable.
  [[nodiscard]] Result<size_t> object_named(std::string_view name) const;
  [[nodiscard]] Result<size_t> thing_named(std::string_view name) const;
  [[nodiscard]] std::string names_there() const;
  [[nodiscard]] const ThingClass& type_of(size_t object) const;
  [[nodiscard]] Pose pose_of_object(size_t object) const;

  Result<double> carry_out(const MoveJoints& command);
  Result<double> carry_out(const MoveHand& command);
  Result<double> carry_out(const LookAt& command);
  Result<double> carry_out(const DriveTo& command);
  Result<double> carry_out(const Drive& command);
  Result<double> carry_out(const Hold& command);
  Result<double> carry_out(const Release& command);
  Result<double> carry_out(const StopAll& command);

  Result<std::string> put_movable(size_t movable, const Pose& at);
  Result<std::string> put_thing(size_t thing, Surface surface);

  std::unique_ptr<World> world_;  ///< Kinematics refers to it, so it stays where it is.
  DrawingSize size_;
  Kinematics kinematics_;
  Trajectory trajectory_;
  PlatformDrive drive_;
  Gaze gaze_;
  uint64_t sample_ = 0;
  bool has_news_ = true;
  std::string blocked_by_;
};

}  // namespace engram::datasets::kitchen
