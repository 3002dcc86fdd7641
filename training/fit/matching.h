// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "ltm/store/store_reader.h"

// Internal to the learning rooms.

namespace engram::training {

/// The entities of a store that any of some queries without selectors matches, in the order of
/// their names; all of them where there are no queries.
/// Errors: kInvalidArgument where a text is no query.
Result<std::vector<ltm::MemoryId>> matching_entities(const ltm::StoreReader& reader,
                                                     std::span<const std::string> texts);

}  // namespace engram::training
