// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/memory/memory_id.h"

namespace engram::ltm {

/// Where work on an entity that takes long is kept in the store's `tmp/`, so that it can go on
/// after its process was killed: "tmp/Vision.RGB.head.cam.0123456789abcdef.checkpoint". No writer
/// removes it; who did the work does. `key` tells one work from another.
[[nodiscard]] std::filesystem::path checkpoint_file(const std::filesystem::path& store,
                                                    const MemoryId& entity, uint64_t key);

/// Whether a file of `tmp/` with this name is one.
[[nodiscard]] bool is_checkpoint(const std::string& name);

/// Removes the checkpoints of `entity`, but for `kept`.
/// Errors: kUnavailable.
Status remove_checkpoints(const std::filesystem::path& store, const MemoryId& entity,
                          std::span<const std::filesystem::path> kept = {});

/// Removes those of entities that are not among `entities`.
/// Errors: kUnavailable.
Status remove_checkpoints_of_others(const std::filesystem::path& store,
                                    const std::vector<MemoryId>& entities);

}  // namespace engram::ltm
