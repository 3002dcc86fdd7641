// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

#include "ltm/core/status.h"

namespace engram {

/// The file descriptors that a child writes to; empty: those of its parent.
struct ChildStreams {
  std::optional<int> output;
  std::optional<int> errors;
};

/// Starts a program as a child in a process group of its own, with no input and with no signal
/// blocked or ignored. `words` is the program, which is searched on the path, and its arguments;
/// not empty. The caller must wait for the child (waitpid).
/// Errors: kUnavailable with the system's reason.
Result<pid_t> start_child(const std::vector<std::string>& words, const ChildStreams& streams);

}  // namespace engram
