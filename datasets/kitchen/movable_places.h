// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: where a chair and a person can be.

#include <Eigen/Core>

#include "datasets/kitchen/robot_body.h"
#include "datasets/kitchen/things.h"
#include "ltm/core/status.h"
#include "ltm/memory/memory_id.h"

namespace engram::datasets::kitchen {

/// Where a movable is while it is not in the room: behind a wall, so that no camera sees it.
[[nodiscard]] Pose place_away(size_t movable);
[[nodiscard]] bool is_away(const Pose& pose);

/// Whether this is the entity of the chair or the person.
[[nodiscard]] bool is_movable(const ltm::MemoryId& object);

/// Returns where a movable stands on the floor.
[[nodiscard]] Pose standing_movable(const ThingClass& type, double x_m, double y_m,
                                    double heading_rad);

/// The distance on the floor from a point to a movable; 0 inside. Frame: world.
[[nodiscard]] double distance_m(const ThingClass& type, const Pose& pose,
                                const Eigen::Vector2d& point);

/// Checks that a movable has room there: inside the walls, not in furniture.
/// Errors: kInvalidArgument naming what is there.
[[nodiscard]] Status check_room_for(const ThingClass& type, const Pose& pose);

}  // namespace engram::datasets::kitchen
