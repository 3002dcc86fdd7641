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

/// Tells by a file or a command whether the robot needs its processors itself.
///
/// Threading: one thread.
class RobotBusy : public Busy {
 public:
  struct Options {
    /// The robot is busy while this file exists. Empty for no file.
    std::filesystem::path file;
    /// The robot is busy while this command ends with exit code 0. Empty for no command. Words are
    /// separated by blanks, without a shell: quotes, variables and pipes do not work. Its stdout is
    /// not read.
    std::string command;
    Duration file_interval = std::chrono::milliseconds(200);
    /// Time from the end of one command to the next. Meanwhile the last answer is valid. A command
    /// that runs longer than this is killed and counts as "not busy".
    Duration command_interval = std::chrono::seconds(10);
  };

  /// Runs the command for the first time and waits for its answer.
  /// Errors: kInvalidArgument if the command cannot be run.
  static Result<std::unique_ptr<RobotBusy>> create(const Options& options);
  ~RobotBusy() override;
  RobotBusy(const RobotBusy&) = delete;
  RobotBusy& operator=(const RobotBusy&) = delete;

  /// Returns why the robot is busy ("/run/robot/busy exists"), or nothing if it is not. It never
  /// waits, and asks no more often than the intervals allow.
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
