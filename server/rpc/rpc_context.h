// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "server/access/access_policy.h"
#include "server/events/event_hub.h"
#include "server/rpc/rpc_metrics.h"
#include "server/rpc/shared_sessions.h"
#include "server/rpc/work_queue.h"
#include "server/service/memory_service.h"

namespace engram::server {

/// What the streams of one server share.
///
/// Threading: thread-safe.
struct RpcContext {
  RpcContext(MemoryService& served, AccessPolicy who_may, int threads)
      : service(served), access(std::move(who_may)), work(threads) {}

  MemoryService& service;
  const AccessPolicy access;
  EventHub hub;
  std::unique_ptr<SharedSessions> sharing;  ///< Null: nothing is shared.
  RpcMetrics metrics;
  std::atomic<int> streams{0};
  int most_streams = 4096;
  MemoryService::Durability durability = MemoryService::Durability::kMemory;
  WorkQueue work;  ///< What takes longer than a stream's thread should. Ends first.
};

/// Counts a stream as long as it lives.
class StreamSlot {
 public:
  explicit StreamSlot(RpcContext& context) : context_(context) {
    ++context_.streams;
    context_.metrics.streams.add(1);
  }
  ~StreamSlot() {
    --context_.streams;
    context_.metrics.streams.add(-1);
  }
  StreamSlot(const StreamSlot&) = delete;
  StreamSlot& operator=(const StreamSlot&) = delete;

 private:
  RpcContext& context_;
};

}  // namespace engram::server
