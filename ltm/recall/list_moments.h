// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>

#include "ltm/memory/select.h"
#include "ltm/recall/known_past.h"

namespace engram::ltm {

/// The contexts of entities that conditions may name although the past does not have them: who asks
/// knows them from other memories.
using OtherContexts = std::map<MemoryId, SharedContext>;

/// What answers the conditions of a query on an entity of a past. `is_named`: the query names the
/// entity letter by letter. Valid as long as `past`.
[[nodiscard]] ListMoments list_moments(KnownPast& past, const MemoryId& entity, bool is_named);

/// The same for who sees through a view: `seen` returns the past of an entity as far as it is seen,
/// and null if nothing is.
using SeenPastOf = std::function<Result<std::unique_ptr<EntityPast>>(const MemoryId& entity)>;
[[nodiscard]] ListMoments list_moments(KnownPast& past, SeenPastOf seen, const MemoryId& entity,
                                       bool is_named,
                                       std::shared_ptr<const OtherContexts> others = {});

/// The same for who has the past of the entity already and selects among its moments: what was
/// committed meanwhile is not listed. `own` must outlive it.
[[nodiscard]] ListMoments list_moments(KnownPast& past, SeenPastOf seen, const MemoryId& entity,
                                       EntityPast& own, bool is_named,
                                       std::shared_ptr<const OtherContexts> others);

/// The context of an entity for who asks another memory: cameras have their intrinsics themselves.
/// Null if there is no such entity, or if nothing of it is seen.
/// Errors: those of the past.
Result<SharedContext> context_for_others(KnownPast& past, const SeenPastOf& seen,
                                         const MemoryId& entity);

}  // namespace engram::ltm
