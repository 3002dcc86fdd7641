// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

#include "ltm/core/status.h"

namespace engram {

/// Where a child writes, as file descriptors; nothing: where its parent does.
struct ChildStreams {
  std::optional<int> output;
  std::optional<int> errors;
};

/// Starts a program as a child in a process group of its own, with nothing to read and no signal
/// blocked or ignored. `words`: the program, looked for on the path, and its arguments; not empty.
/// Who calls it waits for the child (waitpid).
/// Errors: kUnavailable with what the system says.
Result<pid_t> start_child(const std::vector<std::string>& words, const ChildStreams& streams);

}  // namespace engram
