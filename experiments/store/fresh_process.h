// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <nlohmann/json.hpp>

#include "ltm/core/status.h"

namespace engram::experiments {

/// Runs `work` in a child process and returns its result, so that nothing that ran before has
/// warmed or filled its memory. Must be called while this process has only one thread.
/// Errors: those of `work`; kUnavailable if the child cannot start or dies, saying how.
Result<nlohmann::json> in_fresh_process(const std::function<Result<nlohmann::json>()>& work);

}  // namespace engram::experiments
