// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ltm/memory/result.h"

namespace engram::reports {

/// Describes the members of a prediction, without those that are only copied: "position by
/// constant-velocity, RMSE 0.024, 90 %: 0.051, moving; ...". For more than six members it gives the
/// number that each engine predicted. Empty if there are none.
[[nodiscard]] std::string members_text(const ltm::SnapshotResult& snapshot);

}  // namespace engram::reports
