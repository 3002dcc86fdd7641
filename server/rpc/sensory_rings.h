// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <engram/v1/memory.pb.h>

#include <map>
#include <memory>
#include <span>

#include "ltm/core/mutex.h"
#include "ltm/memory/memory_id.h"
#include "server/access/access_policy.h"
#include "server/sharing/block_ref.h"

namespace engram::server {

struct RpcContext;
class SharedRing;

/// The rings into which clients of this host write snapshots of sensory segments: one for each
/// client and segment.
///
/// Threading: thread-safe.
/// Source: docs/sensory.md.
class SensoryRings {
 public:
  /// The max number of rings of one client.
  static constexpr size_t kMaxRings = 16;

  /// `context` must outlive it.
  explicit SensoryRings(RpcContext& context) : context_(context) {}
  ~SensoryRings();

  /// Gives a client a ring for entities that it may write, or the one that it has for their
  /// segment.
  /// Errors: kFailedPrecondition unless all are of one sensory segment; kResourceExhausted where
  /// there is no room in shared memory or in the ring.
  Result<v1::SensoryRing> open(const Identity& who, ClientId client,
                               std::span<const ltm::MemoryId> entities);

  /// Passes those of the first `written` entries of a ring to whose entities somebody attends.
  /// Zero: the client has mapped the ring. Each entry that passes counts against the rate of its
  /// client as a commit does, and a call for nothing counts as well.
  /// Errors: kNotFound unless the client has the ring; what became of the last one.
  Status pass(const Identity& who, ClientId client, uint64_t ring, uint64_t written);

  /// Called when a client is gone.
  void end(ClientId client);

 private:
  using Key = std::pair<ClientId, uint64_t>;

  RpcContext& context_;
  Mutex mutex_;
  uint64_t last_ring_ ENGRAM_GUARDED_BY(mutex_) = 0;
  std::map<Key, std::shared_ptr<SharedRing>> rings_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::server
