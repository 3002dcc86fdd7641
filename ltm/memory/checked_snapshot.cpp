// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/checked_snapshot.h"

#include <unordered_set>

namespace engram::ltm {

Status check_updates(std::span<const Snapshot* const> updates) {
  std::unordered_set<MemoryId> seen;
  for (const Snapshot* update : updates) {
    if (!update->entity.is_entity())
      return invalid_argument("commit: '{}' is no entity: needs four names",
                              update->entity.to_string());
    if (update->instances.empty())
      return invalid_argument("commit: '{}' has no instance, needs at least one",
                              update->id().to_string());
    if (updates.size() > 1 && !seen.insert(update->id()).second)
      return invalid_argument("commit: has '{}' twice, needs each entity and time once",
                              update->id().to_string());
  }
  return {};
}

std::vector<const Snapshot*> pointers_to(std::span<const Snapshot> snapshots) {
  std::vector<const Snapshot*> pointers;
  pointers.reserve(snapshots.size());
  for (const Snapshot& snapshot : snapshots) pointers.push_back(&snapshot);
  return pointers;
}

Result<SnapshotCast> cast_to_type(Snapshot& snapshot, const SegmentTypes& types) {
  SnapshotCast cast;
  if (types.of_entity(snapshot.entity) == nullptr) return cast;
  for (Instance& instance : snapshot.instances) {
    ENGRAM_ASSIGN_OR_RETURN(auto value, types.cast_misfit(snapshot.entity, instance.data));
    if (!value) continue;
    cast.is_cast = true;
    if (!value->notes.empty()) cast.notes.push_back(value->notes.front().to_string());
    instance.data = std::move(value->value);
  }
  return cast;
}

CheckedSnapshot::CheckedSnapshot(Proof proof, const SnapshotCast&)
    : Snapshot(std::move(proof.snapshot)), type_(std::move(proof.type)) {}

bool CheckedSnapshot::is_of(const SegmentTypes& types) const {
  const idf::Type* now = types.of_entity(entity);
  return now == nullptr || (type_ && *type_ == *now);
}

}  // namespace engram::ltm
