// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "ltm/core/status.h"

namespace engram::experiments {

/// What one thread does, again and again.
using Work = std::function<Status()>;
using Works = std::vector<Work>;

/// What threads spent. One that others lock out waits; one that is only interrupted does not.
struct Spent {
  double cpu_seconds = 0;
  double waits = 0;
};

/// One run of several threads.
struct Pass {
  double seconds = 0;  ///< From when the first one begins its work until the last one ends it.
  Spent spent;         ///< Of all.
};

/// Does the first `threads` of the works, each in a thread of its own, begun together. The making
/// of the threads does not count. Needs one at least and as many works (checked).
/// Errors: those of the works, the first one's first.
Result<Pass> run_threads(const Works& works, size_t threads);

}  // namespace engram::experiments
