// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <array>

#include "datasets/kitchen/world.h"

namespace engram::datasets::kitchen {

/// Moves every joint smoothly to its last target.
///
/// A movement between two rests has minimum jerk. A joint that gets another target while it moves
/// continues with its velocity and acceleration.
/// Source: Flash and Hogan, "The coordination of arm movements", 1985: polynomials of degree five.
/// Threading: one thread.
class Trajectory {
 public:
  explicit Trajectory(const RobotVector& at);

  /// Moves a joint, from `now_s` on, to rest at `to` within `duration_s` > 0.
  void move(int joint, double to, double now_s, double duration_s);

  /// Lets a joint move with a velocity, for 20 ms; then it would jump to rest, so whoever drives by
  /// velocities calls this again before.
  void run(int joint, double from, double velocity, double now_s);

  /// Brings all joints to rest soon, near the positions that they would have reached.
  void stop(double now_s);
  /// The same of one joint.
  void stop(int joint, double now_s);

  [[nodiscard]] Motion at(double time_s) const;

  /// The position at which each joint will rest.
  [[nodiscard]] RobotVector goal() const;

 private:
  struct Segment {
    double start_s = 0;
    double duration_s = 0;
    std::array<double, 6> c{};  ///< Coefficients of the powers of the time since the start.
    double goal = 0;
  };
  struct Moment {
    double position, velocity, acceleration;
  };

  static Moment at(const Segment& segment, double time_s);

  std::array<Segment, kRobotJoints> segments_;
};

}  // namespace engram::datasets::kitchen
