// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/recorded_entities.h"

#include <algorithm>
#include <utility>

namespace engram::ltm {

namespace {

/// Max changed snapshots that are listed. It bounds the memory if nobody asks for hours.
constexpr size_t kMaxChanged = 65'536;

}  // namespace

void RecordedEntities::begin_with(EntityIndex sealed,
                                  const std::map<MemoryId, std::optional<Time>>& journals) {
  const ExclusiveLock lock(mutex_);
  sealed_ = std::move(sealed);
  has_all_ = false;
  for (const auto& [entity, last] : journals) {
    Recorded& recorded = find_or_add(entity);
    recorded.until = std::max(recorded.until, last);
  }
}

RecordedEntities::Recorded* RecordedEntities::find(const MemoryId& entity) const {
  if (const auto known = entities_.find(entity); known != entities_.end())
    return known->second.is_gone ? nullptr : &known->second;
  if (has_all_) return nullptr;
  const EntityIndex::Entries& entries = sealed_.of(entity);
  if (entries.empty()) return nullptr;
  return &entities_.emplace(entity, Recorded{last_time_in(entries)}).first->second;
}

RecordedEntities::Recorded& RecordedEntities::find_or_add(const MemoryId& entity) {
  if (Recorded* known = find(entity)) return *known;
  const auto [added, is_new] = entities_.try_emplace(entity);
  if (is_new) ++not_sealed_;
  added->second.is_gone = false;
  return added->second;
}

void RecordedEntities::read_all() const {
  if (has_all_) return;
  for (const auto& [entity, entries] : sealed_.all())
    entities_.try_emplace(entity, Recorded{last_time_in(entries)});
  std::erase_if(entities_, [](const auto& entity) { return entity.second.is_gone; });
  sealed_ = EntityIndex();
  has_all_ = true;
}

void RecordedEntities::correct(const MemoryId& entity, std::optional<Time> until) {
  const ExclusiveLock lock(mutex_);
  if (until) {
    find_or_add(entity).until = until;
  } else if (Recorded* known = find(entity)) {
    *known = {{}, 0, true};
    if (has_all_) entities_.erase(entity);
  }
}

void RecordedEntities::begin(std::span<const SharedSnapshot> snapshots) {
  const ExclusiveLock lock(mutex_);
  ++recordings_;
  for (const SharedSnapshot& snapshot : snapshots) {
    Recorded& entity = find_or_add(snapshot->entity);
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
  Recorded& entity = find_or_add(snapshot.entity());
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
  {
    const SharedLock lock(mutex_);
    const auto known = entities_.find(entity);
    if (known != entities_.end() || has_all_)
      return known == entities_.end() ? std::nullopt : known->second.until;
  }
  const ExclusiveLock lock(mutex_);
  const Recorded* found = find(entity);
  return found == nullptr ? std::nullopt : found->until;
}

bool RecordedEntities::contains(const MemoryId& entity) const {
  {
    const SharedLock lock(mutex_);
    const auto known = entities_.find(entity);
    if (known != entities_.end() || has_all_)
      return known != entities_.end() && !known->second.is_gone;
  }
  const ExclusiveLock lock(mutex_);
  return find(entity) != nullptr;
}

size_t RecordedEntities::size() const {
  const ExclusiveLock lock(mutex_);
  read_all();
  return entities_.size();
}

size_t RecordedEntities::max_size() const {
  const SharedLock lock(mutex_);
  return has_all_ ? entities_.size() : sealed_.max_size() + not_sealed_;
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
  if (const auto names = query.named_entities()) {
    std::ranges::copy_if(*names, std::back_inserter(matching),
                         [this](const MemoryId& name) { return contains(name); });
    return matching;
  }
  {
    const ExclusiveLock lock(mutex_);
    read_all();
  }
  const SharedLock lock(mutex_);
  for (const auto& [entity, recorded] : entities_)
    if (query.matches(entity)) matching.push_back(entity);
  return matching;
}

}  // namespace engram::ltm
