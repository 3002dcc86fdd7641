// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "ltm/core/mutex.h"
#include "memory/memory.h"
#include "server/navigation/cost_map.h"

namespace engram::navigation {

/// The newest cost map of a provider, as its commits come.
///
/// Threading: thread-safe.
/// Owns: nothing of the memory, which must outlive it.
class MapFeed {
 public:
  /// `entity` is that of the maps, see MapRules::entity. There need not be one yet.
  /// Errors: those of Memory::subscribe and query; kInvalidArgument where what is there is no map.
  static Result<std::unique_ptr<MapFeed>> open(Memory& memory, const ltm::MemoryId& entity);

  /// The newest map; null where none came yet. After the connection to the memory was lost, or when
  /// a map was told of without its data, it asks the memory, and returns what was known before
  /// where that fails.
  [[nodiscard]] std::shared_ptr<const CostMap> latest();

  /// Waits until a map of this time or later is there; it asks for none, as latest() does. Returns
  /// false after `timeout`.
  [[nodiscard]] bool wait_for(Time time, Duration timeout) const;

 private:
  MapFeed(Memory& memory, ltm::MemoryId entity) : memory_(memory), entity_(std::move(entity)) {}

  Status ask();
  void take(CostMap map);

  Memory& memory_;
  const ltm::MemoryId entity_;
  mutable Mutex mutex_;
  mutable ConditionVariable came_;
  std::shared_ptr<const CostMap> latest_ ENGRAM_GUARDED_BY(mutex_);
  bool must_ask_ ENGRAM_GUARDED_BY(mutex_) = false;
  std::unique_ptr<Subscription> subscription_;
};

}  // namespace engram::navigation
