// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "server/robot/memory_server.h"

namespace engram::server {

struct PriorCounts {
  size_t entities = 0;
  size_t known = 0;  ///< Of these, as they are: from an earlier start, in the store.
};

/// Tells a server what a robot knows before it lives: types are declared, and what the server does
/// not have yet, of the same time with the same values, is committed.
/// Errors: those of memory::load_prior, memory::MemoryService::declare and
/// memory::MemoryService::commit.
Result<PriorCounts> commit_prior(MemoryServer& server, const std::filesystem::path& directory);

}  // namespace engram::server
