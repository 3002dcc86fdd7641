// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the one place that calls OMPL.

#include <optional>
#include <vector>

#include "ltm/core/time.h"
#include "server/navigation/free_space.h"

namespace engram::navigation {

struct SearchLimits {
  uint32_t seed = 1;
  uint32_t tries = 8;
  Duration time_limit = std::chrono::seconds(1);
};

/// Searches ways between two passable points that hang together by RRTConnect, as often as there
/// are tries, makes each short, and returns the corners of the shortest one with both ends. Nothing
/// where none was found in time. Equal arguments give equal ways, unless the time runs out.
std::optional<std::vector<Eigen::Vector2d>> search_path(const FreeSpace& space,
                                                        const Eigen::Vector2d& start,
                                                        const Eigen::Vector2d& goal,
                                                        const SearchLimits& limits);

}  // namespace engram::navigation
