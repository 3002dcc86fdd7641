// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ltm/memory/memory_id.h"

namespace engram::server {

/// Where the snapshots of an entity were and in which context, as one server tells another one by
/// way of who asks.
struct SentContext {
  ltm::MemoryId entity;
  std::string bytes;
};

}  // namespace engram::server
