// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/decoded_cache.h"

#include "ltm/idf/held_bytes.h"

namespace engram::ltm {

namespace {

/// The nodes of the list and of the index. Unit: bytes.
constexpr size_t kIndexBytes = 200;

}  // namespace

std::optional<SnapshotResult> DecodedCache::find(const MemoryId& id, Prefer prefer) {
  if (entries_.empty()) return std::nullopt;
  const auto found = by_key_.find({id, prefer});
  if (found == by_key_.end()) return std::nullopt;
  entries_.splice(entries_.begin(), entries_, found->second);
  return found->second->snapshot;
}

void DecodedCache::put(const MemoryId& id, Prefer prefer, const SnapshotResult& snapshot) {
  if (max_bytes_ == 0) return;
  // Small snapshots take several times their plain bytes.
  size_t bytes = sizeof(Entry) + kIndexBytes;
  for (const InstanceResult& instance : snapshot.instances)
    bytes += sizeof(instance) + idf::element_bytes(instance.data) + idf::held_bytes(instance.data);
  if (bytes > max_bytes_) return;
  if (const auto known = by_key_.find({id, prefer}); known != by_key_.end()) drop(known->second);
  entries_.push_front({{id, prefer}, snapshot, bytes});
  by_key_.emplace(entries_.front().key, entries_.begin());
  bytes_ += bytes;
  while (bytes_ > max_bytes_) drop(std::prev(entries_.end()));
}

void DecodedCache::erase(const MemoryId& id) {
  for (const Prefer prefer : {Prefer::kRecorded, Prefer::kLatent})
    if (const auto found = by_key_.find({id, prefer}); found != by_key_.end()) drop(found->second);
}

void DecodedCache::clear() {
  entries_.clear();
  by_key_.clear();
  bytes_ = 0;
}

void DecodedCache::drop(std::list<Entry>::iterator entry) {
  bytes_ -= entry->bytes;
  by_key_.erase(entry->key);
  entries_.erase(entry);
}

}  // namespace engram::ltm
