// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <list>
#include <optional>
#include <unordered_map>

#include "ltm/memory/result.h"

namespace engram::server {

/// Snapshots that were decoded from a store, for the next reader. The one that was not asked for
/// longest goes where there are too many bytes.
///
/// Threading: one thread.
class DecodedCache {
 public:
  explicit DecodedCache(size_t most_bytes) : most_bytes_(most_bytes) {}

  [[nodiscard]] std::optional<ltm::SnapshotResult> find(const ltm::MemoryId& id);
  void put(const ltm::MemoryId& id, ltm::SnapshotResult snapshot);
  void erase(const ltm::MemoryId& id);

  [[nodiscard]] size_t bytes() const { return bytes_; }

 private:
  struct Entry {
    ltm::MemoryId id;
    ltm::SnapshotResult snapshot;
    size_t bytes = 0;
  };

  void drop(std::list<Entry>::iterator entry);

  size_t most_bytes_;
  size_t bytes_ = 0;
  std::list<Entry> entries_;  ///< The one that was asked for last in front.
  std::unordered_map<ltm::MemoryId, std::list<Entry>::iterator> by_id_;
};

}  // namespace engram::server
