// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <array>

#include "datasets/kitchen/world.h"

namespace engram::datasets::kitchen {

/// Smooth motion of every joint to where it was last told to go.
///
/// Between rests it has minimum jerk; a joint that is told to go elsewhere on its way goes on with
/// its velocity and acceleration.
/// Source: Flash and Hogan, "The coordination of arm movements", 1985: polynomials of degree five.
/// Threading: one thread.
class Trajectory {
 public:
  explicit Trajectory(const RobotVector& at);

  /// From `now` on the joint moves to rest at `to`, within `duration_s` > 0.
  void move(int joint, double to, double now_s, double duration_s);

  /// All joints come to rest soon, about where they would have got to.
  void stop(double now_s);

  [[nodiscard]] Motion at(double time_s) const;

  /// Where each joint will rest.
  [[nodiscard]] RobotVector goal() const;

 private:
  struct Segment {
    double start_s = 0;
    double duration_s = 0;
    std::array<double, 6> c{};  ///< Of powers of the time since the start.
    double goal = 0;
  };
  struct Moment {
    double position, velocity, acceleration;
  };

  static Moment at(const Segment& segment, double time_s);

  std::array<Segment, kRobotJoints> segments_;
};

}  // namespace engram::datasets::kitchen
