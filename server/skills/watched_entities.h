// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ltm/filter/entity_pattern.h"
#include "memory/memory.h"

namespace engram::skills {

/// Subscribes to all entities that conditions look at, in as few subscriptions
/// as possible.
///
/// Threading: one thread; what comes is handed over by threads of the memory.
class WatchedEntities {
 public:
  using OnSnapshots = std::function<void(std::vector<ToldSnapshot>)>;
  /// Called if snapshots may have been missed.
  using OnGap = std::function<void()>;

  /// `memory` must outlive it.
  WatchedEntities(Memory& memory, OnSnapshots on_snapshots, OnGap on_gap)
      : memory_(memory), on_snapshots_(std::move(on_snapshots)), on_gap_(std::move(on_gap)) {}

  /// Watches what these patterns match, from now on. Patterns are counted: each call needs an
  /// unwatch().
  /// Errors: those of Memory::subscribe.
  Status watch(const std::vector<std::string>& patterns);

  /// Stops watching. What costs little to watch may go on being watched for a while.
  void unwatch(const std::vector<std::string>& patterns);

  /// The last snapshot of each entity that a pattern matches.
  /// Errors: those of Memory::query, without kNotFound: then there are none.
  Result<std::vector<ltm::Snapshot>> latest(const std::string& pattern) {
    return select(pattern, "latest");
  }

  /// The same of another selector (docs/query.md). No snapshot is without instances.
  Result<std::vector<ltm::Snapshot>> select(const std::string& pattern, std::string_view selector);

  /// The snapshot of an entity at a time; nothing if there is none.
  Result<std::optional<ltm::Snapshot>> at(const ltm::MemoryId& entity, Time time);

  /// Subscribes anew to what is watched.
  Status resubscribe();

 private:
  /// Patterns that are kept although nothing needs them: subscribing costs more than they do.
  static constexpr size_t kMaxIdle = 64;

  Memory& memory_;
  const OnSnapshots on_snapshots_;
  const OnGap on_gap_;
  std::map<std::string, int> counts_;  ///< How many need a pattern; 0: nobody does any more.
  std::set<std::string> subscribed_;
  std::vector<std::unique_ptr<Subscription>> subscriptions_;
};

}  // namespace engram::skills
