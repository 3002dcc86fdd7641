// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ltm/core/time.h"
#include "training/night/robot_busy.h"

namespace engram::training {

/// How a long job runs beside other work, and what is left of it when it is killed.
struct JobControl {
  /// Everything is over at about this moment, encoding included; the budget does not count then.
  std::optional<Time> until;
  /// How often training is kept, so that a later job goes on from there. Costs about 12 bytes per
  /// weight of disk. Zero: never.
  Duration checkpoint_interval = std::chrono::minutes(1);
  /// Removes what earlier jobs kept instead of going on from it.
  bool is_fresh = false;
  /// When the robot is busy, training and encoding wait.
  RobotBusy::Options yield = {};

  [[nodiscard]] Status validate() const {
    if (checkpoint_interval < Duration::zero())
      return invalid_argument("time between checkpoints: found {}, needs 0 or more",
                              engram::to_string(checkpoint_interval));
    return {};
  }
};

}  // namespace engram::training
