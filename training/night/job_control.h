// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>

#include "ltm/core/time.h"
#include "training/night/robot_busy.h"

namespace engram::training {

/// Options for running a long job beside other work, and for what is kept if it is killed.
struct JobControl {
  /// The job, including encoding, ends at about this moment, and the budget is ignored.
  std::optional<Time> until;
  /// When the job began, of which this is a part; nothing: it begins now, and alone.
  std::optional<Time> began;
  /// Time between two checkpoints of training, from which a later job continues. A checkpoint takes
  /// about 12 bytes of disk per weight. Zero turns them off.
  Duration checkpoint_interval = std::chrono::minutes(1);
  /// Time after which videos that were encoded are published, where there is nothing to compare
  /// them with. A job that is killed loses no more.
  Duration publish_interval = std::chrono::minutes(2);
  /// Whether to remove the checkpoints of earlier jobs instead of continuing from them.
  bool is_fresh = false;
  /// How to find out whether the robot is busy. Training and encoding wait while it is.
  RobotBusy::Options yield = {};

  [[nodiscard]] Status validate() const {
    if (checkpoint_interval < Duration::zero())
      return invalid_argument("time between checkpoints: found {}, needs 0 or more",
                              engram::to_string(checkpoint_interval));
    if (publish_interval < Duration::zero())
      return invalid_argument("time until something is published: found {}, needs 0 or more",
                              engram::to_string(publish_interval));
    return {};
  }
};

}  // namespace engram::training
