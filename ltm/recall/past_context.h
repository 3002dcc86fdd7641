// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "ltm/memory/sight.h"
#include "ltm/recall/known_past.h"

namespace engram::ltm {

/// The context of snapshots that are held, in the order of time.
[[nodiscard]] EntityContext context_of_held(std::span<const SharedSnapshot> held,
                                            const std::optional<idf::Type>& type);

/// The snapshots of both contexts. Of a moment that both have that of `newer` counts.
[[nodiscard]] SharedContext join_contexts(SharedContext older, EntityContext newer);

/// The snapshots of a context at these times alone.
[[nodiscard]] SharedContext context_at(const SharedContext& all, const TimeWindows& times);
/// The same of times in a list, which increase.
[[nodiscard]] SharedContext context_at(const SharedContext& all, std::span<const Time> times);

}  // namespace engram::ltm
