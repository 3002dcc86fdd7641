// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "ltm/store/store_reader.h"

// Internal to the learning rooms.

namespace engram::training {

/// Returns the entities of a store that match any of some queries without selectors, sorted by
/// name, or all entities if there are no queries.
/// Errors: kInvalidArgument if a text is not a query.
Result<std::vector<ltm::MemoryId>> matching_entities(const ltm::StoreReader& reader,
                                                     std::span<const std::string> texts);

}  // namespace engram::training
