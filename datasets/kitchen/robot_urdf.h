// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the robot as a URDF, for whoever draws it or computes with it.

#include <string>

#include "datasets/kitchen/world.h"

namespace engram::datasets::kitchen {

/// Returns the robot as a URDF without meshes: boxes, cylinders and spheres.
///
/// It is read from the compiled model, so a link and the simulated part of the same name have the
/// same pose. Joints have the names of joint_names(). The platform's three joints are not in it:
/// the root link "platform" stands where the platform is. A joint's link is "NAME_link", or has the
/// name of its part where that has one: "torso", "neck", "head", "left_hand", "right_hand". Links
/// "left_camera" and "right_camera" are the cameras. Frame: of cameras as World::camera_pose.
[[nodiscard]] std::string robot_urdf(const World& world);

}  // namespace engram::datasets::kitchen
