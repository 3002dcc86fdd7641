// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace engram::cli {

/// What a run of the program left behind.
struct RunResult {
  int exit_code = -1;  ///< Minus the signal where one ended it.
  std::string out;
  std::string err;
};

/// Runs the program to its end.
RunResult run_engram(const std::vector<std::string>& arguments);

/// Runs the program and kills it (SIGKILL) after `milliseconds`, or as soon as stderr or stdout
/// holds `until`, whichever comes first; exit_code says whether it was done before.
RunResult run_engram_and_kill(const std::vector<std::string>& arguments, int milliseconds,
                              const std::string& until = "");

/// A program that runs beside the test. Killed when this goes.
class RunningEngram {
 public:
  explicit RunningEngram(const std::vector<std::string>& arguments);
  ~RunningEngram();
  RunningEngram(const RunningEngram&) = delete;
  RunningEngram& operator=(const RunningEngram&) = delete;

  /// Waits until stdout or stderr holds `text`; false where the program ended before, or did not
  /// say so within 30 s.
  bool wait_for(const std::string& text);

  /// What it wrote to stdout until the last call of wait_for.
  [[nodiscard]] const std::string& out() const;

  /// Waits for its end, of itself or by a signal (0: none); see RunResult.
  RunResult end(int signal);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A short rendered recording in `directory`, made once per process: {video, table}.
struct Recording {
  std::string video;
  std::string table;
};
Recording make_recording(const std::filesystem::path& directory, int seconds);

inline const std::string kCamera = "Vision/RGB/head/cam";
inline const std::string kJoints = "RobotState/Proprioception/robot/joints";

/// `engram import` of a recording at 5 Hz into `store`, begun at `start`.
std::vector<std::string> import_arguments(const Recording& recording, const std::string& store,
                                          const std::string& start = "2022-02-18 13:00:00");

}  // namespace engram::cli
