// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <unordered_map>
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

/// A context takes less than its snapshots, of which a segment has no more.
inline constexpr size_t kMaxContextPlainBytes = size_t{2} << 30;

/// Reads one of what pack_contexts() wrote; nothing if there is none of the entity. Safe on hostile
/// bytes: what it returns is consistent, and takes about `max_bytes` at most.
/// Errors: kDataLoss.
Result<std::optional<EntityContext>> unpack_context(std::span<const std::byte> bytes,
                                                    const MemoryId& entity,
                                                    size_t max_bytes = kMaxContextPlainBytes);

/// Where each context lies in what pack_contexts() wrote, by the printed ID of its entity. Valid as
/// long as the bytes.
using PackedContexts = std::unordered_map<std::string_view, std::span<const std::byte>>;

/// Finds all contexts without reading them. Errors: kDataLoss.
Result<PackedContexts> list_contexts(std::span<const std::byte> bytes);

/// Reads one that was found. Safe on hostile bytes. Errors: kDataLoss.
Result<EntityContext> unpack_listed(std::span<const std::byte> packed,
                                    size_t max_bytes = kMaxContextPlainBytes);

/// Reads all of them. Errors: kDataLoss.
Result<SegmentContexts> unpack_contexts(std::span<const std::byte> bytes);

}  // namespace engram::ltm
