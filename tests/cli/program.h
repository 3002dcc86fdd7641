// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
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
