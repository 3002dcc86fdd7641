// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what the robot does in a recording.

#include <optional>
#include <string>

#include "datasets/kitchen/kinematics.h"
#include "datasets/kitchen/reporter.h"
#include "datasets/kitchen/script.h"
#include "datasets/kitchen/trajectory.h"

namespace engram::datasets::kitchen {

/// Carries out one task after another until the recording is over.
///
/// Its steps read as one runs after the other: each lets time pass, in which the world moves and
/// is recorded. Once the time is over nothing moves and nothing is reported any more.
/// Threading: one thread. World and reporter outlive it.
class Episode {
 public:
  Episode(const KitchenOptions& options, World& world, Reporter& reporter, ProgressSink progress);

  Status run();

  [[nodiscard]] const KitchenSummary& summary() const { return summary_; }

 private:
  using Outcome = ::kitchen::Outcome;

  /// An action that has begun.
  struct Running {
    ::kitchen::Action action;
    size_t thing = 0;
  };

  /// What the cameras follow.
  struct Gaze {
    std::optional<size_t> thing;
    Eigen::Vector3d point{0, 0, 0};
  };

  /// Lets the world move for so long, rounded up to whole images.
  Status wait(double seconds);
  [[nodiscard]] bool is_over() const { return sample_ >= samples_; }
  [[nodiscard]] double now_s() const;
  /// Turns the neck after what the cameras follow.
  void follow();

  Status perform(const Task& task);
  Status look(const Task& task);
  Status navigate(const Task& task, Surface to);
  Result<bool> pick(const Task& task, std::optional<GraspFault> fault);
  Result<bool> place(const Task& task);
  /// Somebody stops a reach that has begun, and lets it go on.
  Status stop_reach(Running& running);
  Status open_and_draw_back(Side side);
  Status rest_arm(Side side, double seconds);

  void move_joints(const std::vector<int>& joints, const std::vector<double>& to, double seconds);
  /// Starts a hand and the torso on their way. Gives how far from there the hand will end.
  double move_hand(Side side, const Pose& pose_world_hand, double seconds);

  Running begin(const Task& task, const std::string& skill, std::optional<Surface> surface);
  void end(Running& running, Outcome outcome, const std::string& reason,
           std::optional<ltm::MemoryId> stopped_by = std::nullopt);
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
