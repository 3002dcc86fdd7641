// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "server/robot/memory_server.h"

namespace engram::server {

struct PriorCounts {
  size_t entities = 0;
  /// Those that the store already had from an earlier start, with the same values.
  size_t known = 0;
};

/// Gives a server the robot's prior knowledge: declares its types, and commits every snapshot that
/// the server does not already have at the same time with the same values.
/// Errors: those of memory::load_prior, memory::MemoryService::declare and
/// memory::MemoryService::commit.
Result<PriorCounts> commit_prior(MemoryServer& server, const std::filesystem::path& directory);

}  // namespace engram::server
