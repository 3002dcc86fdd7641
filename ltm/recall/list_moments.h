// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/memory/select.h"
#include "ltm/recall/known_past.h"

namespace engram::ltm {

/// What answers the conditions of a query on an entity of a past. `is_named`: the query names the
/// entity letter by letter. Valid as long as `past`.
[[nodiscard]] ListMoments list_moments(KnownPast& past, const MemoryId& entity, bool is_named);

/// The same for who sees through a view: `seen` returns the past of an entity as far as it is seen,
/// and null if nothing is.
using SeenPastOf = std::function<Result<std::unique_ptr<EntityPast>>(const MemoryId& entity)>;
[[nodiscard]] ListMoments list_moments(KnownPast& past, SeenPastOf seen, const MemoryId& entity,
                                       bool is_named);

}  // namespace engram::ltm
