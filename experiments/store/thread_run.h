// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "ltm/core/status.h"

namespace engram::experiments {

/// The work that one thread repeats.
using Work = std::function<Status()>;
using Works = std::vector<Work>;

/// The costs of threads. A thread that others lock out waits; one that is only interrupted does
/// not.
struct Spent {
  double cpu_seconds = 0;
  double waits = 0;
};

/// One run of several threads.
struct Pass {
  double seconds = 0;  ///< From the begin of the first thread's work to the end of the last one's.
  Spent spent;         ///< The costs of all threads.
};

/// Runs the first `threads` works, each in its own thread, started together. The time to make the
/// threads does not count. `threads` must be 1 to works.size() (checked).
/// Errors: those of the works, the first one's first.
Result<Pass> run_threads(const Works& works, size_t threads);

}  // namespace engram::experiments
