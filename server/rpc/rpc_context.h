// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "server/events/event_hub.h"
#include "server/rpc/work_queue.h"
#include "server/service/memory_service.h"

namespace engram::server {

/// What the streams of one server share.
///
/// Threading: thread-safe.
struct RpcContext {
  RpcContext(MemoryService& served, int threads) : service(served), work(threads) {}

  MemoryService& service;
  EventHub hub;
  WorkQueue work;  ///< What takes longer than a stream's thread should.
  MemoryService::Durability durability = MemoryService::Durability::kMemory;
};

}  // namespace engram::server
