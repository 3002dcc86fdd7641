// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <nlohmann/json.hpp>

#include "ltm/core/status.h"

namespace engram::experiments {

/// Runs `work` in a child process, so that nothing that ran before has warmed or filled its
/// memory, and hands over what it found. Call it while this process has one thread.
/// Errors: that of `work`; kUnavailable where the child cannot start or dies, saying how.
Result<nlohmann::json> in_fresh_process(const std::function<Result<nlohmann::json>()>& work);

}  // namespace engram::experiments
