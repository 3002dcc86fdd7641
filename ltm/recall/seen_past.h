// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "ltm/memory/sight.h"
#include "ltm/recall/known_past.h"

namespace engram::ltm {

/// The past of an entity as if there were nothing but its snapshots at `times`. Null if that leaves
/// none, so it cannot be told from an entity that is not there.
/// Errors: those of Moments.
/// Complexity: nth() and count() take a binary search by index for each window.
Result<std::unique_ptr<EntityPast>> seen_past(std::unique_ptr<EntityPast> past,
                                              const TimeWindows& times);

}  // namespace engram::ltm
