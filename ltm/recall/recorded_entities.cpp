// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/recorded_entities.h"

#include <algorithm>
#include <utility>

namespace engram::ltm {

namespace {

/// Max changed snapshots that are listed. It bounds the memory if nobody asks for hours.
constexpr size_t kMaxChanged = 65'536;

}  // namespace

void RecordedEntities::add(const MemoryId& entity, std::optional<Time> until) {
  const ExclusiveLock lock(mutex_);
  entities_[entity].until = until;
}

void RecordedEntities::correct(const MemoryId& entity, std::optional<Time> until) {
  const ExclusiveLock lock(mutex_);
  if (until)
    entities_[entity].until = until;
  else
    entities_.erase(entity);
}

void RecordedEntities::begin(std::span<const SharedSnapshot> snapshots) {
  const ExclusiveLock lock(mutex_);
  ++recordings_;
  for (const SharedSnapshot& snapshot : snapshots) {
    Recorded& entity = entities_[snapshot->entity];
    entity.until = std::max(entity.until.value_or(snapshot->time), snapshot->time);
  }
}

void RecordedEntities::finish(std::span<const SharedSnapshot> snapshots,
                              std::span<const MemoryId> released) {
  const ExclusiveLock lock(mutex_);
  ++recordings_;
  for (const SharedSnapshot& snapshot : snapshots) note_changed(snapshot->id());
  for (const MemoryId& snapshot : released) note_changed(snapshot);
}

void RecordedEntities::note_changed(MemoryId snapshot) {
  // Known since begin(), unless all that was known of it has been forgotten since.
  Recorded& entity = entities_[snapshot.entity()];
  entity.at = recordings_;
  entity.until = std::max(entity.until.value_or(*snapshot.time()), *snapshot.time());
  if (changed_.snapshots.size() == kMaxChanged) changed_ = {{}, true};
  if (!changed_.is_all) changed_.snapshots.push_back(std::move(snapshot));
}

RecordedEntities::Changed RecordedEntities::take_changed() {
  const ExclusiveLock lock(mutex_);
  return std::exchange(changed_, {});
}

std::optional<Time> RecordedEntities::known_until(const MemoryId& entity) const {
  const SharedLock lock(mutex_);
  const auto found = entities_.find(entity);
  return found == entities_.end() ? std::nullopt : found->second.until;
}

bool RecordedEntities::contains(const MemoryId& entity) const {
  const SharedLock lock(mutex_);
  return entities_.contains(entity);
}

size_t RecordedEntities::size() const {
  const SharedLock lock(mutex_);
  return entities_.size();
}

uint64_t RecordedEntities::recorded_at(const MemoryId& entity) const {
  const SharedLock lock(mutex_);
  const auto found = entities_.find(entity);
  return found == entities_.end() ? 0 : found->second.at;
}

uint64_t RecordedEntities::recordings() const {
  const SharedLock lock(mutex_);
  return recordings_;
}

std::vector<MemoryId> RecordedEntities::matching(const Query& query) const {
  std::vector<MemoryId> matching;
  const auto names = query.named_entities();
  const SharedLock lock(mutex_);
  if (names) {
    for (const MemoryId& name : *names)
      if (entities_.contains(name)) matching.push_back(name);
    return matching;
  }
  for (const auto& [entity, recorded] : entities_)
    if (query.matches(entity)) matching.push_back(entity);
  return matching;
}

}  // namespace engram::ltm
