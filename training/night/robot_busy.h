// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "ltm/core/status.h"
#include "ltm/core/time.h"
#include "training/fit/busy.h"

namespace engram::training {

/// Says whether the robot needs its processors itself: a file or a command tells.
///
/// Threading: one thread.
class RobotBusy : public Busy {
 public:
  struct Options {
    /// The robot is busy while this exists. Empty: not asked.
    std::filesystem::path file;
    /// The robot is busy while this ends with exit code 0. Empty: not asked. Words are divided by
    /// blanks and no shell reads them: no quotes, variables or pipes. Its stdout is not read.
    std::string command;
    Duration file_interval = std::chrono::milliseconds(200);
    /// From the end of one command to the next; what is known meanwhile stays true. A command that
    /// runs longer than this is killed and counts as "not busy".
    Duration command_interval = std::chrono::seconds(10);
  };

  /// Asks the command for the first time, and waits for its answer.
  /// Errors: kInvalidArgument where the command cannot be run.
  static Result<std::unique_ptr<RobotBusy>> create(const Options& options);
  ~RobotBusy() override;
  RobotBusy(const RobotBusy&) = delete;
  RobotBusy& operator=(const RobotBusy&) = delete;

  /// Why the robot is busy ("/run/robot/busy exists"); nothing where it is not. Never waits, and
  /// asks no more often than the intervals say.
  [[nodiscard]] std::optional<std::string> reason() override;

 private:
  class Command;
  explicit RobotBusy(Options options);

  Options options_;
  std::unique_ptr<Command> command_;
  std::chrono::steady_clock::time_point next_look_{};
  bool has_file_ = false;
};

}  // namespace engram::training
