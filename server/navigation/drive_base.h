// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/core/time.h"
#include "server/navigation/planar_pose.h"

namespace engram::navigation {

/// How a platform moves.
struct Twist {
  double forward_m_s = 0;
  double turn_rad_s = 0;  ///< From the x axis to the y axis.

  friend bool operator==(const Twist&, const Twist&) = default;
};

/// Where a platform is at a moment of its clock.
struct BaseState {
  Time time{};
  PlanarPose pose_world_robot;  ///< Its middle; it drives along its x axis.
  Twist twist;
};

/// The platform of a robot, as far as a drive needs it.
///
/// Threading: one thread.
class DriveBase {
 public:
  virtual ~DriveBase() = default;

  virtual Result<BaseState> state() = 0;

  /// Moves like this until the next call. A platform that hears nothing for half a second ought to
  /// stop by itself: whoever drives it may have died.
  virtual Status move(const Twist& twist) = 0;

  /// Comes to rest as quickly as it may.
  virtual Status stop() = 0;

  /// Waits on the clock of the platform, which in a simulation need not be that of the system.
  virtual Status wait(Duration time) = 0;
};

}  // namespace engram::navigation
