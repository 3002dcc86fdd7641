// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "memory/memory.h"
#include "server/navigation/map_rules.h"
#include "server/navigation/navigation_types.h"

namespace engram::navigation {

/// Where a robot may stand to be at a place that was asked for by name.
struct NamedGoal {
  std::string name;        ///< As the memory calls it.
  ltm::MemoryId location;  ///< The snapshot of the location or object that the name is of.
  /// The best one first: one pose for a location, many around an object.
  std::vector<PlanarPose> poses;
};

/// The entity of a location.
/// Errors: kInvalidArgument where a name is empty or no UTF-8.
Result<ltm::MemoryId> location_entity(const std::string& provider, const std::string& name);

/// Commits a location under its name.
/// Errors: kInvalidArgument where it has no name, or neither a pose in the world nor one beside an
/// object; those of Memory::commit.
Status commit_location(Memory& memory, const std::string& provider,
                       const ::navigation::Location& location, Time time);

/// Finds where to go for a name: a location by its name or one of its aliases, then an object or
/// piece of furniture that the map has, then a thing that stands on one of those. `chair` finds the
/// one next to the robot of `chair_1`, `chair_2`. Case does not count, and `_` is a space.
///
/// `rules` are those of the map: they say which things there are, and in which member each has its
/// pose. A location that is no navigation::Location is skipped.
///
/// Beside an object the robot faces it: furniture from its front (where its x axis points away from
/// the robot), all else from where the robot is.
/// Errors: kNotFound naming the closest names that there are; kInvalidArgument for a location that
/// does not say where it is; those of Memory::query.
Result<NamedGoal> find_goal(Memory& memory, const MapRules& rules, const std::string& name,
                            const CostMap& map, const PlanarPose& robot);

}  // namespace engram::navigation
