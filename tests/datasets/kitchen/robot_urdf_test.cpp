// SPDX-License-Identifier: Apache-2.0
// The robot's URDF stands where the simulated robot stands, whatever its joints do.
#include "datasets/kitchen/robot_urdf.h"

#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <random>
#include <regex>
#include <set>
#include <sstream>

namespace engram::datasets::kitchen {
namespace {

constexpr DrawingSize kNoPicture{.width = 32, .height = 32, .samples = 0, .shadow_map = 0};

struct UrdfJoint {
  std::string name;
  std::string type;
  std::string parent;
  std::string child;
  Pose origin = Pose::Identity();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  double lower = 0;
  double upper = 0;
};

std::string attribute(const std::string& text, const std::string& element,
                      const std::string& name) {
  std::smatch match;
  const std::regex pattern("<" + element + "\\b[^>]*\\b" + name + "=\"([^\"]*)\"");
  return std::regex_search(text, match, pattern) ? match[1].str() : "";
}

Eigen::Vector3d vector_in(const std::string& text) {
  std::istringstream stream(text);
  Eigen::Vector3d vector = Eigen::Vector3d::Zero();
  stream >> vector.x() >> vector.y() >> vector.z();
  EXPECT_FALSE(stream.fail()) << text;
  return vector;
}

/// The joints of a URDF, as its specification reads them.
std::vector<UrdfJoint> joints_in(const std::string& urdf) {
  std::vector<UrdfJoint> joints;
  const std::regex pattern("<joint [^]*?</joint>");
  for (std::sregex_iterator at(urdf.begin(), urdf.end(), pattern), end; at != end; ++at) {
    const std::string text = at->str();
    UrdfJoint joint{attribute(text, "joint", "name"), attribute(text, "joint", "type"),
                    attribute(text, "parent", "link"), attribute(text, "child", "link")};
    joint.origin.translation() = vector_in(attribute(text, "origin", "xyz"));
    const Eigen::Vector3d rpy = vector_in(attribute(text, "origin", "rpy"));
    joint.origin.linear() = (Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) *
                             Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
                             Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX()))
                                .toRotationMatrix();
    if (joint.type != "fixed") {
      joint.axis = vector_in(attribute(text, "axis", "xyz"));
      joint.lower = std::stod(attribute(text, "limit", "lower"));
      joint.upper = std::stod(attribute(text, "limit", "upper"));
    }
    joints.push_back(joint);
  }
  return joints;
}

/// Poses of all links for a pose of the robot; a parent comes before its children.
std::map<std::string, Pose> link_poses(const std::vector<UrdfJoint>& joints,
                                       const RobotVector& robot) {
  Pose base = Pose::Identity();
  base.translation() = Eigen::Vector3d(robot[0], robot[1], 0);
  base.linear() = Eigen::AngleAxisd(robot[2], Eigen::Vector3d::UnitZ()).toRotationMatrix();
  std::map<std::string, Pose> poses{{"platform", base}};
  for (const UrdfJoint& joint : joints) {
    Pose moved = poses.at(joint.parent) * joint.origin;
    const double position = joint.type == "fixed" ? 0 : robot[joint_index(joint.name)];
    if (joint.type == "prismatic") moved.translate(position * joint.axis);
    if (joint.type == "revolute") moved.rotate(Eigen::AngleAxisd(position, joint.axis));
    poses[joint.child] = moved;
  }
  return poses;
}

RobotVector anywhere(const World& world, std::mt19937& random) {
  RobotVector robot;
  for (int i = 0; i < kRobotJoints; ++i) {
    const auto [lower, upper] = i < kPlatformJoints ? std::pair(-3.0, 3.0) : world.range(i);
    robot[i] = std::uniform_real_distribution<double>(lower, upper)(random);
  }
  return robot;
}

TEST(KitchenRobotUrdf, HasItsLinksWhereTheSimulatedRobotHasItsParts) {
  auto world = World::create(make_layout(1), kNoPicture);
  ASSERT_TRUE(world.ok()) << world.status().to_string();
  const std::vector<UrdfJoint> joints = joints_in(robot_urdf(*world));
  std::mt19937 random(7);
  constexpr double kMax_m = 0.001;
  constexpr double kMax_rad = 0.1 * std::numbers::pi / 180;
  for (int trial = 0; trial < 20; ++trial) {
    const RobotVector robot = trial == 0 ? resting_pose() : anywhere(*world, random);
    world->place_robot(robot);
    const std::map<std::string, Pose> links = link_poses(joints, robot);
    std::map<std::string, Pose> parts;
    for (const char* name : {"platform", "torso", "neck", "head", "left_hand", "right_hand"})
      parts[name] = world->body_pose(name);
    parts["left_camera"] = world->camera_pose(Side::kLeft);
    parts["right_camera"] = world->camera_pose(Side::kRight);
    // Parts without a name are found by their joints, and their links by the last of those.
    const mjModel& model = world->model();
    for (int i = kPlatformJoints; i < kRobotJoints; ++i) {
      const int joint = model.dof_jntid[world->dof(i)];
      const int body = model.jnt_bodyid[joint];
      const bool is_last = joint + 1 == model.body_jntadr[body] + model.body_jntnum[body];
      if (is_last && mj_id2name(&model, mjOBJ_BODY, body) == nullptr)
        parts[joint_names().at(static_cast<size_t>(i)) + "_link"] = pose_of(world->data(), body);
    }
    EXPECT_EQ(parts.size(), 8u + 30u);
    for (const auto& [name, pose] : parts) {
      ASSERT_TRUE(links.contains(name)) << name;
      const Pose apart = links.at(name).inverse() * pose;
      EXPECT_LT(apart.translation().norm(), kMax_m) << name << ", trial " << trial;
      EXPECT_LT(Eigen::AngleAxisd(apart.linear()).angle(), kMax_rad) << name << ", trial " << trial;
    }
  }
}

TEST(KitchenRobotUrdf, HasEveryJointOnceWithItsRange) {
  auto world = World::create(make_layout(1), kNoPicture);
  ASSERT_TRUE(world.ok()) << world.status().to_string();
  std::set<std::string> moving;
  std::set<std::string> children;
  for (const UrdfJoint& joint : joints_in(robot_urdf(*world))) {
    EXPECT_TRUE(children.insert(joint.child).second) << joint.child;
    if (joint.type == "fixed") continue;
    EXPECT_TRUE(moving.insert(joint.name).second) << joint.name;
    const auto [lower, upper] = world->range(joint_index(joint.name));
    EXPECT_NEAR(joint.lower, lower, 1e-9) << joint.name;
    EXPECT_NEAR(joint.upper, upper, 1e-9) << joint.name;
  }
  EXPECT_EQ(moving,
            std::set<std::string>(joint_names().begin() + kPlatformJoints, joint_names().end()));
  EXPECT_FALSE(children.contains("platform"));
}

TEST(KitchenRobotUrdf, IsMadeOfShapesThatNeedNoFiles) {
  auto world = World::create(make_layout(1), kNoPicture);
  ASSERT_TRUE(world.ok()) << world.status().to_string();
  const std::string urdf = robot_urdf(*world);
  const std::regex geometry("<geometry><(\\w+) [^>]*/></geometry><material name=\"(\\w+)\"/>");
  std::map<std::string, int> shapes;
  for (std::sregex_iterator at(urdf.begin(), urdf.end(), geometry), end; at != end; ++at) {
    ++shapes[(*at)[1].str()];
    EXPECT_NE(urdf.find("<material name=\"" + (*at)[2].str() + "\"><color"), std::string::npos);
  }
  EXPECT_EQ(shapes.size(), 3u);
  EXPECT_GT(shapes["box"], 5);
  EXPECT_GT(shapes["cylinder"], 30);
  EXPECT_GT(shapes["sphere"], 60);
  EXPECT_EQ(urdf.find("://"), std::string::npos);
  EXPECT_EQ(urdf.find("nan"), std::string::npos);
}

}  // namespace
}  // namespace engram::datasets::kitchen
