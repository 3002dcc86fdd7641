// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include "datasets/kitchen/trajectory.h"

namespace engram::datasets::kitchen {

/// Lets the platform follow a velocity that changes at any time.
///
/// Frame: velocities are the platform's: forward, left, turn. Unit: m/s, rad/s.
/// Threading: one thread.
class PlatformDrive {
 public:
  static constexpr double kHolds_s = 0.3;  ///< How long a velocity holds.
  static constexpr double kMax_m_s = 1.0;
  static constexpr double kMax_rad_s = 1.5;

  void want(const Eigen::Vector3d& velocity, double now_s);
  /// Leaves the platform to the trajectory.
  void end() { is_on_ = false; }

  /// Moves the trajectory of the platform by one step of `step_s`, as far as it is driven.
  void step(double now_s, double step_s, Trajectory& trajectory);

 private:
  bool is_on_ = false;
  Eigen::Vector3d wanted_{0, 0, 0};
  double until_s_ = 0;
};

}  // namespace engram::datasets::kitchen
