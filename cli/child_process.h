// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "ltm/core/status.h"

namespace engram::cli {

/// A child process without input, in a process group of its own, whose output is read.
struct ChildProcess {
  /// The program, which is looked up on PATH, and its arguments.
  std::vector<std::string> arguments;
  /// Called with every line of its stderr, without the line break.
  std::function<void(const std::string& line)> on_error_line;
  std::string output = {};  ///< All of its stdout, once it has ended.
  int exit_code = -1;       ///< 128 plus the signal if a signal ended it.
};

/// Runs all children concurrently until all have ended. A stop ends them like Ctrl-C.
/// Errors: kUnavailable if one cannot be started; those started before it are stopped.
/// Threading: lines are delivered on the calling thread.
Status run_children(std::vector<ChildProcess>& children, const std::stop_token& stop);

/// Called by a child of run_children(): it then ends, as by Ctrl-C, when its parent ends.
void end_with_parent();

}  // namespace engram::cli
