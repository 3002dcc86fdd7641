// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "ltm/core/status.h"

namespace engram::cli {

/// A child process with nothing to read, in a process group of its own, whose output is read.
struct ChildProcess {
  std::vector<std::string> arguments;  ///< The program first, looked for on the path.
  /// Called with every line of its stderr, without its end.
  std::function<void(const std::string& line)> on_error_line;
  std::string output = {};  ///< All of its stdout, once it has ended.
  int exit_code = -1;       ///< 128 and the signal where one ended it.
};

/// Runs children at once until all have ended. A stop ends them as Ctrl-C would.
/// Errors: kUnavailable where one cannot be started; those before it are stopped.
/// Threading: lines are told in this thread.
Status run_children(std::vector<ChildProcess>& children, const std::stop_token& stop);

/// A child of run_children() that calls it ends, as by Ctrl-C, when its parent does.
void end_with_parent();

}  // namespace engram::cli
