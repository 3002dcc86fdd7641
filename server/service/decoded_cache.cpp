// SPDX-License-Identifier: Apache-2.0
#include "server/service/decoded_cache.h"

#include "ltm/idf/binary.h"

namespace engram::server {

std::optional<ltm::SnapshotResult> DecodedCache::find(const ltm::MemoryId& id) {
  const auto found = by_id_.find(id);
  if (found == by_id_.end()) return std::nullopt;
  entries_.splice(entries_.begin(), entries_, found->second);
  return found->second->snapshot;
}

void DecodedCache::put(const ltm::MemoryId& id, ltm::SnapshotResult snapshot) {
  size_t bytes = sizeof(Entry);
  for (const ltm::InstanceResult& instance : snapshot.instances)
    bytes += idf::encoded_size(instance.data);
  if (bytes > most_bytes_) return;
  erase(id);
  entries_.push_front({id, std::move(snapshot), bytes});
  by_id_.emplace(id, entries_.begin());
  bytes_ += bytes;
  while (bytes_ > most_bytes_) drop(std::prev(entries_.end()));
}

void DecodedCache::erase(const ltm::MemoryId& id) {
  if (const auto found = by_id_.find(id); found != by_id_.end()) drop(found->second);
}

void DecodedCache::drop(std::list<Entry>::iterator entry) {
  bytes_ -= entry->bytes;
  by_id_.erase(entry->id);
  entries_.erase(entry);
}

}  // namespace engram::server
