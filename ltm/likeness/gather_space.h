// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>

#include "ltm/core/progress.h"
#include "ltm/likeness/likeness_space.h"
#include "ltm/recall/known_past.h"

namespace engram::ltm {

/// An entity without this many images has no codes: too few to learn from, and quickly looked
/// through.
inline constexpr size_t kMinCodedSnapshots = 16;

/// Learns the space of an entity from at most 3,000 of its moments, evenly spaced over all of them.
/// `times` are all its moments. The same past gives the same space.
/// Errors: kFailedPrecondition if fewer than two of these moments have an image; kCancelled as
/// soon as `is_over`, which is asked before each moment; those of reading.
Result<LikenessSpace> learn_space(KnownPast& past, const MemoryId& entity,
                                  std::span<const Time> times, const ProgressSink& progress,
                                  const std::function<bool()>& is_over);

}  // namespace engram::ltm
