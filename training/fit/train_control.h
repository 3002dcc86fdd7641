// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>

#include "ltm/core/time.h"

namespace engram::training {

class JobPace;

/// Options for running training beside other work and across processes. They do not change the
/// result of a fixed number of steps.
struct TrainControl {
  /// Training ends at this moment instead of after the budget.
  std::optional<Time> end;
  /// File of the checkpoint, from which training continues if its key fits (see checkpoint_key). It
  /// is not removed when training is done. If it is empty, no checkpoint is kept.
  std::filesystem::path checkpoint;
  Duration checkpoint_interval = std::chrono::minutes(1);
  /// Pauses training while the robot is busy; null to never pause.
  JobPace* pace = nullptr;
};

}  // namespace engram::training
