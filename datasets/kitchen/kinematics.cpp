// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/kinematics.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace engram::datasets::kitchen {

namespace {

constexpr int kSteps = 150;
constexpr double kSolverDamping = 0.02;
constexpr double kTurnWeight = 0.25;  ///< The distance in m that an error of one radian counts as.
constexpr double kPull = 0.02;
constexpr double kMaxChange = 0.15;
constexpr double kClose_m = 0.0005;
constexpr double kPalm_m = 0.018;     ///< From the middle of the hand to the surface of the palm.
constexpr double kDown_rad = 0.12;    ///< How much a hand points down.
constexpr double kInward_rad = 0.25;  ///< How much a hand turns inward for round things.

double wrapped(double angle, double period) {
  return angle - period * std::round(angle / period);
}

}  // namespace

Kinematics::Kinematics(const World& world)
    : world_(world),
      state_(mj_makeData(&world.model())),
      jacobian_(6 * static_cast<size_t>(world.model().nv)) {}

void Kinematics::set(const RobotVector& robot) {
  world_.set_robot(robot, *state_);
  mj_kinematics(&world_.model(), state_.get());
  mj_comPos(&world_.model(), state_.get());
}

Kinematics::Answer Kinematics::solve(const RobotVector& from, Side side,
                                     const Pose& pose_world_hand) {
  std::vector<int> joints = arm_joints(side);
  for (const char* name : {"torso_lift", "torso_pitch", "torso_yaw"})
    joints.push_back(joint_index(name));
  const auto count = static_cast<Eigen::Index>(joints.size());
  const RobotVector rest = resting_pose();
  const mjModel& model = world_.model();
  const int body = mj_name2id(&model, mjOBJ_BODY, (std::string(to_string(side)) + "_hand").c_str());
  const auto nv = static_cast<Eigen::Index>(model.nv);
  // The torso moves less readily than an arm.
  Eigen::VectorXd ease = Eigen::VectorXd::Ones(count);
  ease.tail(3) << 0.25, 0.35, 0.25;

  Answer answer{from, 0};
  for (int step = 0; step < kSteps; ++step) {
    set(answer.pose);
    const Pose hand = pose_of(*state_, body);
    const Eigen::AngleAxisd turn(pose_world_hand.linear() * hand.linear().transpose());
    Eigen::Matrix<double, 6, 1> error;
    error << pose_world_hand.translation() - hand.translation(),
        kTurnWeight * turn.angle() * turn.axis();
    answer.error_m = error.head<3>().norm();
    if (error.norm() < kClose_m) break;
    mj_jacBody(&model, state_.get(), jacobian_.data(), jacobian_.data() + 3 * nv, body);
    Eigen::MatrixXd j(6, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const int dof = world_.dof(joints[static_cast<size_t>(i)]);
      for (Eigen::Index row = 0; row < 6; ++row)
        j(row, i) = (row < 3 ? 1 : kTurnWeight) * jacobian_[static_cast<size_t>(row * nv + dof)];
    }
    Eigen::VectorXd pull(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const int joint = joints[static_cast<size_t>(i)];
      pull[i] = kPull * (rest[joint] - answer.pose[joint]);
    }
    const Eigen::MatrixXd eased = j * ease.asDiagonal();
    const Eigen::Matrix<double, 6, 6> square =
        eased * j.transpose() + kSolverDamping * kSolverDamping * Eigen::MatrixXd::Identity(6, 6);
    const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> solver(square);
    Eigen::VectorXd change = pull + eased.transpose() * solver.solve(error - j * pull);
    change *= std::min(1.0, kMaxChange / std::max(1e-9, change.cwiseAbs().maxCoeff()));
    for (Eigen::Index i = 0; i < count; ++i) {
      const int joint = joints[static_cast<size_t>(i)];
      const auto [low, high] = world_.range(joint);
      answer.pose[joint] = std::clamp(answer.pose[joint] + change[i], low, high);
    }
  }
  return answer;
}

std::pair<double, double> Kinematics::look_at(const RobotVector& robot,
                                              const Eigen::Vector3d& point) {
  RobotVector straight = robot;
  straight[joint_index("neck_yaw")] = straight[joint_index("neck_pitch")] = 0;
  set(straight);
  const int head = mj_name2id(&world_.model(), mjOBJ_BODY, "head");
  const Eigen::Vector3d to =
      pose_of(*state_, head).inverse() * point - Eigen::Vector3d(0, 0, kEye_z_m);
  const auto [low_yaw, high_yaw] = world_.range(joint_index("neck_yaw"));
  const auto [low_pitch, high_pitch] = world_.range(joint_index("neck_pitch"));
  return {std::clamp(std::atan2(to.y(), to.x()), low_yaw, high_yaw),
          std::clamp(std::atan2(-to.z(), std::hypot(to.x(), to.y())), low_pitch, high_pitch)};
}

Grasp grasp_of(const ThingClass& type, const Pose& pose_world_thing, Side side,
               double heading_rad) {
  const double toward = -sign_of(side);  // The palm faces this direction of the hand's y axis.
  const Eigen::Vector3d axis = pose_world_thing.linear().col(0);
  const double turn = std::atan2(axis.y(), axis.x());
  double approach = heading_rad + toward * kInward_rad;
  if (type.shape == Shape::kBox)
    approach = turn + std::numbers::pi * std::round((heading_rad - turn) / std::numbers::pi);
  Grasp grasp{.width_m = type.size_m.y()};
  const double ahead = std::max(0.085, 0.5 * type.size_m.x() + 0.035);
  const Eigen::Matrix3d hand =
      (Eigen::AngleAxisd(wrapped(approach - turn, 2 * std::numbers::pi), Eigen::Vector3d::UnitZ()) *
       Eigen::AngleAxisd(kDown_rad, Eigen::Vector3d::UnitY()))
          .toRotationMatrix();
  const Eigen::Vector3d middle(0, 0, type.grasp_height_m - 0.5 * type.size_m.z());
  grasp.pose_thing_hand.linear() = hand;
  grasp.pose_thing_hand.translation() =
      middle - hand * Eigen::Vector3d(ahead, toward * (kPalm_m + 0.5 * grasp.width_m), 0);
  return grasp;
}

}  // namespace engram::datasets::kitchen
