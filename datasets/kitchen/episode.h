// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the behaviour of the robot in a recording.

#include <optional>
#include <string>

#include "datasets/kitchen/kinematics.h"
#include "datasets/kitchen/reporter.h"
#include "datasets/kitchen/script.h"
#include "datasets/kitchen/trajectory.h"

namespace engram::datasets::kitchen {

/// Carries out one task after another until the recording is over.
///
/// The steps are written as if they ran one after the other: each of them lets time pass, in which
/// the world moves and is recorded. When the time is over, nothing moves and nothing is reported.
/// Threading: one thread. World and reporter must outlive it.
class Episode {
 public:
  Episode(const KitchenOptions& options, World& world, Reporter& reporter, ProgressSink progress);

  Status run();

  [[nodiscard]] const KitchenSummary& summary() const { return summary_; }

 private:
  using Outcome = ::skill::Outcome;

  /// An action that has begun and has not ended.
  struct Running {
    std::string skill;
    ::kitchen::Action action;
    size_t thing = 0;
  };

  /// The target that the cameras follow.
  struct Gaze {
    std::optional<size_t> thing;
    Eigen::Vector3d point{0, 0, 0};
  };

  /// Lets the world move for this time, rounded up to whole images.
  Status wait(double seconds);
  [[nodiscard]] bool is_over() const { return sample_ >= samples_; }
  [[nodiscard]] double now_s() const;
  /// Turns the neck towards the target of the cameras.
  void follow();

  Status perform(const Task& task);
  Status look(const Task& task);
  Status navigate(const Task& task, Surface to);
  Result<bool> pick(const Task& task, std::optional<GraspFault> fault);
  Result<bool> place(const Task& task);
  /// A person stops a reach that has begun, and later tells the robot to continue.
  Status stop_reach(Running& running);
  Status open_and_draw_back(Side side);
  Status rest_arm(Side side, double seconds);

  void move_joints(const std::vector<int>& joints, const std::vector<double>& to, double seconds);
  /// Starts to move a hand and the torso. Returns the distance from the target at which the hand
  /// will end.
  double move_hand(Side side, const Pose& pose_world_hand, double seconds);

  Running begin(const Task& task, const std::string& skill, std::optional<Surface> surface);
  void end(Running& running, Outcome outcome, const std::string& reason,
           const std::optional<ltm::MemoryId>& stopped_by = std::nullopt);
  void plan(const Task& task, const ltm::MemoryId& command);

  World& world_;
  Reporter& reporter_;
  ProgressSink progress_;
  Script script_;
  Kinematics kinematics_;
  Trajectory trajectory_;
  Gaze gaze_;
  uint64_t seed_;
  uint64_t sample_ = 0;
  uint64_t samples_;
  int actions_ = 0;
  bool has_stopped_ = false;
  ltm::MemoryId plan_id_;
  KitchenSummary summary_;
};

}  // namespace engram::datasets::kitchen
