// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: part of robot_config.

#include <cstdint>
#include <optional>
#include <string_view>

#include "ltm/core/config.h"
#include "ltm/working/working_memory.h"
#include "memory/live/sensory_memory.h"

namespace engram::server {

/// Reads a count of at least one, where it is there.
Status read_count(ConfigMap& map, std::string_view key, std::optional<size_t>& out);

/// Reads 'working_memory', 'segments' and 'sensory_memory' of a server: how much its working memory
/// may hold, and of what, and what precedes it. `min_bytes` is what it may take even if the
/// machine's RAM is tight. Errors: kInvalidArgument naming file, line and key. Source:
/// docs/server.md, section "Configuration".
Status read_working_memory(ConfigMap& map, ltm::WorkingMemory::Options& memory,
                           memory::SensoryMemory::Options& sensory, uint64_t& min_bytes);

}  // namespace engram::server
