// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ltm/memory/memory_id.h"

namespace engram::ltm {

/// `SystemState/Replay/scores/` and the ID of an entity: what tells how good the predictions of that
/// entity were.
[[nodiscard]] MemoryId score_id(const MemoryId& predicted);

/// The entity whose predictions another one tells of; nothing if it tells of none.
[[nodiscard]] std::optional<MemoryId> scored_entity(const MemoryId& entity);

}  // namespace engram::ltm
