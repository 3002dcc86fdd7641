// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>

#include "ltm/core/time.h"

namespace engram::training {

class JobPace;

/// How training runs beside other work, and outlives its process: nothing of it changes what so
/// many steps learn.
struct TrainControl {
  /// Training ends at this moment instead of after the budget.
  std::optional<Time> end;
  /// Kept here now and then, and gone on from where it fits; a training that is done leaves it.
  /// Empty: nowhere. See checkpoint_key.
  std::filesystem::path checkpoint;
  Duration checkpoint_interval = std::chrono::minutes(1);
  /// Where training waits while the robot is busy; null: it never does.
  JobPace* pace = nullptr;
};

}  // namespace engram::training
