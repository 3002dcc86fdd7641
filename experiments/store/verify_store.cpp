// SPDX-License-Identifier: Apache-2.0
#include "store/verify_store.h"

#include "ltm/store/store_reader.h"

namespace engram::experiments {

namespace {

Status verify_snapshot(const ltm::Snapshot& found, const Stream& stream) {
  const size_t tick = stream.tick_at(found.time);
  if (tick < stream.ticks())
    for (const ltm::Snapshot& said : commit_of(stream.tick(tick)).updates)
      if (said == found) return {};
  return data_loss("snapshot '{}': is not what the stream said", found.id().to_string());
}

}  // namespace

Status verify_store(const std::filesystem::path& store, const Stream& stream, uint64_t snapshots) {
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, ltm::StoreReader::open(store));
  uint64_t found = 0;
  for (const ltm::MemoryId& entity : reader->entities()) {
    ENGRAM_ASSIGN_OR_RETURN(const auto* entries, reader->index(entity));
    for (const ltm::SnapshotEntry& entry : *entries) {
      ENGRAM_ASSIGN_OR_RETURN(const auto snapshot, reader->read_recorded(entity, entry));
      ENGRAM_RETURN_IF_ERROR(verify_snapshot(snapshot, stream));
      found += 1;
    }
  }
  if (found != snapshots)
    return data_loss("store '{}': holds {} snapshots, needs {}", store.string(), found, snapshots);
  return {};
}

uint64_t count_snapshots(const Stream& stream) {
  uint64_t count = 0;
  for (size_t i = 0; i < stream.ticks(); ++i) count += commit_of(stream.tick(i)).updates.size();
  return count;
}

}  // namespace engram::experiments
