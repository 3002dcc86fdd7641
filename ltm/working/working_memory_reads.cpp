// SPDX-License-Identifier: Apache-2.0
// The answers of a working memory. Searches hold the shared lock and change nothing but counters.
#include "ltm/core/mutex.h"
#include "ltm/working/working_memory_state.h"

namespace engram::ltm {

uint64_t WorkingMemory::taken() const {
  const SharedLock lock(state_->mutex);
  return state_->queued - state_->waiting.size();
}

bool WorkingMemory::has(const MemoryId& entity) const {
  const SharedLock lock(state_->mutex);
  return state_->find(entity) != nullptr;
}

size_t WorkingMemory::entity_count() const {
  const SharedLock lock(state_->mutex);
  return state_->entities.size();
}

SharedSnapshot WorkingMemory::find(const MemoryId& id) const {
  const SharedLock lock(state_->mutex);
  if (!id.has_entity()) return nullptr;
  const KeptEntity* entity = id.is_entity() ? state_->find(id) : state_->find(id.entity());
  if (entity == nullptr || entity->history.empty()) return nullptr;
  if (!id.time()) {
    state_->count_reads(*entity, 1);
    return entity->history.back().snapshot;
  }
  const auto index = entity->history.find(*id.time());
  if (!index) return nullptr;
  state_->count_reads(*entity, 1);
  return entity->history[*index].snapshot;
}

std::vector<SelectedEntity> WorkingMemory::select(const Query& query,
                                                  const KnownElsewhere& elsewhere) const {
  std::vector<SelectedEntity> selected;
  const auto names = query.named_entities();
  const SharedLock lock(state_->mutex);
  if (names) {
    for (const MemoryId& id : *names)
      if (const KeptEntity* entity = state_->find(id))
        state_->select(*entity, query, elsewhere, selected);
    return selected;
  }
  for (const auto& [id, entity] : state_->entities)
    if (query.matches(id)) state_->select(*entity, query, elsewhere, selected);
  return selected;
}

std::vector<MemoryId> WorkingMemory::matching(const Query& query) const {
  std::vector<MemoryId> matching;
  const auto names = query.named_entities();
  const SharedLock lock(state_->mutex);
  if (names) {
    for (const MemoryId& id : *names)
      if (state_->find(id) != nullptr) matching.push_back(id);
    return matching;
  }
  for (const auto& [id, entity] : state_->entities)
    if (query.matches(id)) matching.push_back(id);
  return matching;
}

std::vector<SharedSnapshot> WorkingMemory::all_of(const MemoryId& entity, size_t max) const {
  std::vector<SharedSnapshot> all;
  const SharedLock lock(state_->mutex);
  const KeptEntity* kept = state_->find(entity);
  if (kept == nullptr) return all;
  const size_t count = std::min(max, kept->history.size());
  all.reserve(count);
  for (size_t i = kept->history.size() - count; i < kept->history.size(); ++i)
    all.push_back(kept->history[i].snapshot);
  return all;
}

void WorkingMemory::count_reads(const MemoryId& entity, size_t count) const {
  const SharedLock lock(state_->mutex);
  if (const KeptEntity* kept = state_->find(entity)) state_->count_reads(*kept, count);
}

std::optional<idf::Type> WorkingMemory::type_of(const MemoryId& entity) const {
  const SharedLock lock(state_->mutex);
  const idf::Type* type = state_->types.of_entity(entity);
  return type == nullptr ? std::nullopt : std::optional(*type);
}

QueryResult WorkingMemory::query(const Query& query) const {
  QueryResult result(query.is_ids_only());
  for (const SelectedEntity& entity : select(query)) {
    EntityResult& answer = result.add_entity(entity.entity);
    if (!query.is_ids_only()) count_reads(entity.entity, entity.snapshots.size());
    for (size_t i = 0; i < entity.snapshots.size(); ++i) {
      SnapshotResult one =
          result_of(*entity.snapshots[i], entity.instances[i], query.is_ids_only());
      if (!one.instances.empty()) answer.add(std::move(one));
    }
  }
  return result;
}

}  // namespace engram::ltm
