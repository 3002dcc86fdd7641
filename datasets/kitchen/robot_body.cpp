// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/robot_body.h"

#include <algorithm>
#include <cmath>

#include "ltm/core/check.h"

namespace engram::datasets::kitchen {

namespace {

constexpr std::array kArmJoints{"shoulder_pitch", "shoulder_roll", "shoulder_yaw", "elbow",
                                "forearm_roll",   "wrist_pitch",   "wrist_yaw"};
constexpr std::array kHandJoints{"thumb_1", "thumb_2", "thumb_3",  "thumb_4",
                                 "index_1", "index_2", "middle_1", "middle_2",
                                 "ring_1",  "ring_2",  "little_1", "little_2"};

template <typename Names>
std::vector<int> indices(Side side, const Names& names) {
  std::vector<int> found;
  for (const char* name : names)
    found.push_back(joint_index(std::string(to_string(side)) + "_" + name));
  return found;
}

}  // namespace

const std::array<std::string, kRobotJoints>& joint_names() {
  static const auto kNames = [] {
    std::array<std::string, kRobotJoints> names{"platform_x", "platform_y",  "platform_yaw",
                                                "torso_lift", "torso_pitch", "torso_yaw",
                                                "neck_yaw",   "neck_pitch"};
    size_t next = 8;
    for (const char* side : {"left_", "right_"}) {
      for (const char* name : kArmJoints) names.at(next++) = std::string(side) + name;
      for (const char* name : kHandJoints) names.at(next++) = std::string(side) + name;
    }
    return names;
  }();
  return kNames;
}

int joint_index(std::string_view name) {
  const auto& names = joint_names();
  const auto found = std::find(names.begin(), names.end(), name);
  ENGRAM_CHECK(found != names.end(), "the robot has no joint '{}'", name);
  return static_cast<int>(found - names.begin());
}

std::vector<int> arm_joints(Side side) {
  return indices(side, kArmJoints);
}

std::vector<int> hand_joints(Side side) {
  return indices(side, kHandJoints);
}

std::vector<double> open_hand() {
  return {1.15, 0.9, 0.25, 0.15, 0.12, 0.10, 0.10, 0.10, 0.10, 0.10, 0.12, 0.10};
}

std::vector<double> hand_around(double width_m) {
  // The thumb leans until the distance of its tip from the palm is the width of the thing.
  const double reach = std::clamp((width_m + 0.016) / kThumbBase_m, 0.0, 1.0);
  const double lean = std::acos(reach);
  return {lean, 1.50, 0.10, 0.12, 0.10, 0.28, 0.10, 0.28, 0.10, 0.28, 0.10, 0.28};
}

RobotVector resting_pose() {
  RobotVector pose = RobotVector::Zero();
  pose[joint_index("neck_pitch")] = 0.35;
  for (const Side side : {Side::kLeft, Side::kRight}) {
    const std::vector<int> arm = arm_joints(side);
    const std::array<double, 7> angles{-0.25, 0.22, 0.10, 1.75, 0.0, 0.0, 0.0};
    for (size_t i = 0; i < arm.size(); ++i) pose[arm[i]] = angles.at(i);
    const std::vector<int> hand = hand_joints(side);
    const std::vector<double> open = open_hand();
    for (size_t i = 0; i < hand.size(); ++i) pose[hand[i]] = open[i];
  }
  return pose;
}

}  // namespace engram::datasets::kitchen
