// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/platform_drive.h"

#include <algorithm>

namespace engram::datasets::kitchen {

namespace {

// It is at rest 0.4 s after any velocity that it may have.
constexpr double kMax_m_s2 = 2.6;
constexpr double kMax_rad_s2 = 4.0;

}  // namespace

void PlatformDrive::want(const Eigen::Vector3d& velocity, double now_s) {
  is_on_ = true;
  wanted_ = velocity;
  const double length = wanted_.head<2>().norm();
  if (length > kMax_m_s) wanted_.head<2>() *= kMax_m_s / length;
  wanted_.z() = std::clamp(wanted_.z(), -kMax_rad_s, kMax_rad_s);
  until_s_ = now_s + kHolds_s;
}

void PlatformDrive::step(double now_s, double step_s, Trajectory& trajectory) {
  if (!is_on_) return;
  if (now_s >= until_s_) wanted_.setZero();
  const Motion now = trajectory.at(now_s);
  const Eigen::Rotation2Dd turn(now.position[2]);
  Eigen::Vector3d wanted = wanted_;
  wanted.head<2>() = turn * wanted_.head<2>();
  bool is_at_rest = wanted_.isZero();
  for (int i = 0; i < kPlatformJoints; ++i) {
    const double max_change = (i == 2 ? kMax_rad_s2 : kMax_m_s2) * step_s;
    const double velocity =
        now.velocity[i] + std::clamp(wanted[i] - now.velocity[i], -max_change, max_change);
    trajectory.run(i, now.position[i], velocity, now_s);
    is_at_rest = is_at_rest && velocity == 0;
  }
  if (is_at_rest) is_on_ = false;
}

}  // namespace engram::datasets::kitchen
