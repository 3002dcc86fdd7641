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

/// Names the file in the store's `tmp/` that keeps the state of long work on an entity, so that the
/// work can go on after its process was killed:
/// "tmp/Vision.RGB.head.cam.0123456789abcdef.checkpoint". Writers never remove it; the process that
/// does the work has to. `key` distinguishes one piece of work from another.
[[nodiscard]] std::filesystem::path checkpoint_file(const std::filesystem::path& store,
                                                    const MemoryId& entity, uint64_t key);

/// Names the file in the store's `tmp/` that keeps what nights found out about an entity, so that
/// the next one need not find it out again: "tmp/Vision.RGB.head.cam.history". It is no part of the
/// memory. remove_checkpoints_of_others() removes it.
[[nodiscard]] std::filesystem::path history_file(const std::filesystem::path& store,
                                                 const MemoryId& entity);

/// Whether `name`, of a file in `tmp/`, is that of a checkpoint.
[[nodiscard]] bool is_checkpoint(const std::string& name);
/// Whether it is that of one of `entity`, finished or not.
[[nodiscard]] bool is_checkpoint_of(const std::string& name, const MemoryId& entity);
/// Whether `name` is that of a history.
[[nodiscard]] bool is_history(const std::string& name);

/// Removes the checkpoints of `entity` except those in `kept`.
/// Errors: kUnavailable.
Status remove_checkpoints(const std::filesystem::path& store, const MemoryId& entity,
                          std::span<const std::filesystem::path> kept = {});

/// Removes the checkpoints and histories of all entities that are not in `entities`.
/// Errors: kUnavailable.
Status remove_checkpoints_of_others(const std::filesystem::path& store,
                                    const std::vector<MemoryId>& entities);

}  // namespace engram::ltm
