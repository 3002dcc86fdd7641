// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "memory/memory.h"
#include "server/navigation/map_rules.h"
#include "server/navigation/navigation_types.h"

namespace engram::navigation {

/// Refuses a plan that was made on what is no longer so: an object of its map was moved since,
/// came, or went. An object that was seen again where it was changes nothing.
///
/// It looks at the objects themselves and not at a newer map, so that it also finds what a cost map
/// provider that died never told of. `rules` are those of the map's provider.
/// Errors: kFailedPrecondition naming an object, when the plan knows it and when the memory does;
/// also for a plan without a way or without a map that is in the memory. Those of Memory::query.
Status check_plan(Memory& memory, const ::navigation::Plan& plan, const MapRules& rules);

/// The same of what a map was made of.
Status check_map(Memory& memory, const CostMap& map, const MapRules& rules);

/// Reads the map at a link.
/// Errors: kNotFound where there is none; those of CostMap::from_data and Memory::query.
Result<CostMap> map_at(Memory& memory, const ltm::MemoryId& link);

/// The value at a link to a snapshot or an instance; without an instance the first one.
/// Errors: kNotFound where there is none; those of Memory::query.
Result<idf::Data> value_at(Memory& memory, const ltm::MemoryId& link);

}  // namespace engram::navigation
