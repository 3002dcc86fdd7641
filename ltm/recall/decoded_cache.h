// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <list>
#include <map>
#include <optional>

#include "ltm/recall/known_past.h"

namespace engram::ltm {

/// A cache of snapshots that were decoded from a store. It evicts the least recently used ones when
/// it holds more than its maximum of bytes.
///
/// Threading: one thread.
class DecodedCache {
 public:
  /// With 0 it keeps nothing.
  explicit DecodedCache(size_t max_bytes) : max_bytes_(max_bytes) {}

  /// `prefer` is the form that was asked for: the cache keeps both forms of a snapshot apart.
  [[nodiscard]] std::optional<SnapshotResult> find(const MemoryId& id, Prefer prefer);
  void put(const MemoryId& id, Prefer prefer, const SnapshotResult& snapshot);
  /// Erases both forms.
  void erase(const MemoryId& id);
  void clear();

  [[nodiscard]] size_t bytes() const { return bytes_; }

 private:
  using Key = std::pair<MemoryId, Prefer>;
  struct Entry {
    Key key;
    SnapshotResult snapshot;
    size_t bytes = 0;
  };

  void drop(std::list<Entry>::iterator entry);

  size_t max_bytes_;
  size_t bytes_ = 0;
  std::list<Entry> entries_;  ///< The most recently used one in front.
  std::map<Key, std::list<Entry>::iterator> by_key_;
};

}  // namespace engram::ltm
