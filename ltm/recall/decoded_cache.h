// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <list>
#include <map>
#include <optional>

#include "ltm/recall/known_past.h"

namespace engram::ltm {

/// Snapshots that were decoded from a store, for the next who asks. Where there are too many bytes,
/// the one that was not asked for longest goes.
///
/// Threading: one thread.
class DecodedCache {
 public:
  /// Zero: it keeps nothing.
  explicit DecodedCache(size_t max_bytes) : max_bytes_(max_bytes) {}

  /// `prefer`: by which form it was read; an entity may be asked for in both.
  [[nodiscard]] std::optional<SnapshotResult> find(const MemoryId& id, Prefer prefer);
  void put(const MemoryId& id, Prefer prefer, const SnapshotResult& snapshot);
  /// In whatever form.
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
  std::list<Entry> entries_;  ///< The one that was asked for last in front.
  std::map<Key, std::list<Entry>::iterator> by_key_;
};

}  // namespace engram::ltm
