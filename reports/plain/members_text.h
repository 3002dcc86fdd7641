// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ltm/memory/result.h"

namespace engram::reports {

/// "position by constant-velocity, RMSE 0.024, 90 %: 0.051, moving; ..." of a prediction whose
/// members count; of more than six: how many each engine predicted. Empty where nothing tells.
[[nodiscard]] std::string members_text(const ltm::SnapshotResult& snapshot);

}  // namespace engram::reports
