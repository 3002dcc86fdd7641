// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "memory/memory.h"
#include "server/navigation/floor_things.h"
#include "server/navigation/obstacle_map.h"

namespace engram::navigation {

/// Tells `things` of what a memory knows: the last snapshots of all that counts, or those up to a
/// time.
/// Errors: those of Memory::query, but not that there is nothing.
Status tell_things(Memory& memory, FloorThings& things, std::optional<Time> at = {});

/// What a memory knows of the things on the floor: their last snapshots, or those up to a time.
/// Errors: those of FloorThings::create and Memory::query, but not that there is nothing.
Result<FloorThings> known_things(Memory& memory, const MapRules& rules,
                                 std::optional<Time> at = {});

/// Brings a map up to date with what changed of things since the last call. Returns whether any
/// did.
bool apply_changes(FloorThings& things, const MapRules& rules, ObstacleMap& map);

/// The map of these things as `made` has it, with version 0 and without an ID.
[[nodiscard]] CostMap map_of_things(const FloorThings& things, ObstacleMap& made);

/// A map of these things, made at once, with version 0. Its ID is where it belongs, at the time of
/// the newest of them; it is not committed. Without things its ID is empty.
/// Errors: the same.
Result<CostMap> map_of_known_things(Memory& memory, const MapRules& rules,
                                    std::optional<Time> at = {});

}  // namespace engram::navigation
