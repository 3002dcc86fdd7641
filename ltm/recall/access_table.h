// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>

#include "ltm/memory/memory_id.h"

namespace engram::ltm {

/// How often a snapshot was read, and when last.
struct AccessStats {
  uint64_t count = 0;
  Time last{};  ///< Undefined if `count` is 0.

  friend bool operator==(const AccessStats&, const AccessStats&) = default;
};

/// The reads of a store's snapshots that were noted.
///
/// Threading: const-parallel.
class AccessTable {
 public:
  using Snapshots = std::map<Time, AccessStats>;

  /// Adds `count` reads of one snapshot, the last of them at `last`.
  void add(const MemoryId& entity, Time snapshot, uint64_t count, Time last);

  void add(const AccessTable& other);

  /// Returns zero reads if none was noted.
  [[nodiscard]] AccessStats find(const MemoryId& entity, Time snapshot) const;

  void erase(const MemoryId& entity, Time snapshot);

  [[nodiscard]] const std::map<MemoryId, Snapshots>& all() const { return entities_; }
  [[nodiscard]] bool empty() const { return entities_.empty(); }
  /// Number of snapshots that were read.
  [[nodiscard]] size_t size() const;
  void clear() { entities_.clear(); }

 private:
  std::map<MemoryId, Snapshots> entities_;  ///< Each value has at least one snapshot.
};

}  // namespace engram::ltm
