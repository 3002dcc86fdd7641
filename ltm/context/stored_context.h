// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "ltm/context/entity_context.h"

namespace engram::ltm {

/// The kind of the index that holds the contexts of a segment (ltm/store/segment_index.h).
inline constexpr const char* kContextIndex = "context";

/// The contexts of the entities of a segment.
using SegmentContexts = std::vector<std::pair<MemoryId, EntityContext>>;

/// Packs contexts so that one can be read without the others.
[[nodiscard]] std::vector<std::byte> pack_contexts(const SegmentContexts& contexts);

/// Reads one of what pack_contexts() wrote; nothing if there is none of the entity. Safe on hostile
/// bytes: what it returns is consistent.
/// Errors: kDataLoss.
Result<std::optional<EntityContext>> unpack_context(std::span<const std::byte> bytes,
                                                    const MemoryId& entity);

/// Reads all of them. Errors: kDataLoss.
Result<SegmentContexts> unpack_contexts(std::span<const std::byte> bytes);

}  // namespace engram::ltm
