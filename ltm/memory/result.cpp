// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/result.h"

#include <algorithm>
#include <span>

#include "ltm/idf/binary.h"

namespace engram::ltm {

namespace {

const std::string& name_of(const EntityResult& entity) {
  return entity.id.names().back();
}
template <typename Below>
const std::string& name_of(const NameResult<Below>& level) {
  return level.name;
}

/// The position of `name` among siblings, or where to insert it.
template <typename Level>
auto place_of(std::vector<Level>& siblings, const std::string& name) {
  // Answers are mostly built in the order of names, which makes the end the usual position.
  if (!siblings.empty() && name_of(siblings.back()) < name) return siblings.end();
  return std::ranges::lower_bound(
      siblings, name, {}, [](const Level& level) -> auto& { return name_of(level); });
}

template <typename Below>
NameResult<Below>& find_or_add(std::vector<NameResult<Below>>& siblings, const std::string& name) {
  const auto place = place_of(siblings, name);
  if (place != siblings.end() && place->name == name) return *place;
  return *siblings.insert(place, NameResult<Below>{name, {}});
}

template <typename Level>
const Level* find(const std::vector<Level>& siblings, const std::string& name) {
  const auto place = std::ranges::lower_bound(
      siblings, name, {}, [](const Level& level) -> auto& { return name_of(level); });
  return place != siblings.end() && name_of(*place) == name ? &*place : nullptr;
}

void collect(const std::vector<EntityResult>& level, std::vector<const EntityResult*>& entities) {
  for (const EntityResult& entity : level) entities.push_back(&entity);
}
template <typename Below>
void collect(const std::vector<NameResult<Below>>& level,
             std::vector<const EntityResult*>& entities) {
  for (const NameResult<Below>& one : level) collect(one.below, entities);
}

bool has_names(const std::vector<EntityResult>& level, std::span<const std::string> names) {
  return names.empty() || find(level, names.front()) != nullptr;
}
template <typename Below>
bool has_names(const std::vector<NameResult<Below>>& level, std::span<const std::string> names) {
  if (names.empty()) return true;
  const NameResult<Below>* found = find(level, names.front());
  return found != nullptr && has_names(found->below, names.subspan(1));
}

void add_instance(std::vector<InstanceResult>& instances, InstanceResult added) {
  const auto place = std::ranges::lower_bound(instances, added.index, {}, &InstanceResult::index);
  if (place == instances.end() || place->index != added.index)
    instances.insert(place, std::move(added));
}

void append_ids(const EntityResult& entity, std::vector<MemoryId>& ids) {
  if (entity.snapshots.empty()) ids.push_back(entity.id);
  for (const SnapshotResult& snapshot : entity.snapshots) {
    const MemoryId id = entity.id.at(snapshot.time);
    if (snapshot.instances.empty()) ids.push_back(id);
    for (const InstanceResult& instance : snapshot.instances)
      ids.push_back(id.instance(instance.index));
  }
}

}  // namespace

const InstanceResult* SnapshotResult::find(int32_t index) const {
  const auto place = std::ranges::lower_bound(instances, index, {}, &InstanceResult::index);
  return place != instances.end() && place->index == index ? &*place : nullptr;
}

void SnapshotResult::append(idf::Data data, const InstanceMetadata& metadata,
                            std::optional<MeasuredError> error,
                            std::optional<MeasuredError> bound) {
  const auto index = static_cast<int32_t>(instances.size());
  instances.push_back({index, std::move(data), metadata, error, bound});
}

const SnapshotResult* EntityResult::find(Time time) const {
  const auto place = std::ranges::lower_bound(snapshots, time, {}, &SnapshotResult::time);
  return place != snapshots.end() && place->time == time ? &*place : nullptr;
}

void EntityResult::add(SnapshotResult snapshot) {
  // Memories answer in the order of time; only uniting the answers of several inserts.
  if (snapshots.empty() || snapshots.back().time < snapshot.time) {
    snapshots.push_back(std::move(snapshot));
    return;
  }
  const auto place = std::ranges::lower_bound(snapshots, snapshot.time, {}, &SnapshotResult::time);
  if (place->time != snapshot.time) {
    snapshots.insert(place, std::move(snapshot));
  } else if (snapshot.source < place->source) {
    *place = std::move(snapshot);
  } else if (snapshot.source == place->source) {
    for (InstanceResult& instance : snapshot.instances)
      add_instance(place->instances, std::move(instance));
  }
}

EntityResult& QueryResult::add_entity(const MemoryId& entity) {
  ENGRAM_CHECK(entity.is_entity(), "'{}' is no entity", entity.to_string());
  const std::vector<std::string>& names = entity.names();
  auto& core_segments = find_or_add(memories_, names[0]).below;
  auto& provider_segments = find_or_add(core_segments, names[1]).below;
  auto& entities = find_or_add(provider_segments, names[2]).below;
  const auto place = place_of(entities, names[3]);
  if (place != entities.end() && name_of(*place) == names[3]) return *place;
  return *entities.insert(place, EntityResult{entity, {}});
}

Status QueryResult::merge(QueryResult other) {
  if (is_ids_only_ != other.is_ids_only_)
    return invalid_argument("results: one has only IDs and the other data, needs two of a kind");
  for (const EntityResult* entity : other.entities()) {
    EntityResult& place = add_entity(entity->id);
    for (const SnapshotResult& snapshot : entity->snapshots) place.add(snapshot);
  }
  return {};
}

std::vector<const EntityResult*> QueryResult::entities() const& {
  std::vector<const EntityResult*> entities;
  collect(memories_, entities);
  return entities;
}

const EntityResult* QueryResult::find_entity(const MemoryId& id) const {
  if (!id.has_entity()) return nullptr;
  const MemoryResult* memory = find(memories_, id.names()[0]);
  const auto* core = memory != nullptr ? find(memory->below, id.names()[1]) : nullptr;
  const auto* provider = core != nullptr ? find(core->below, id.names()[2]) : nullptr;
  return provider != nullptr ? find(provider->below, id.names()[3]) : nullptr;
}

const SnapshotResult* QueryResult::find_snapshot(const MemoryId& id) const {
  const EntityResult* entity = id.time() ? find_entity(id) : nullptr;
  return entity != nullptr ? entity->find(*id.time()) : nullptr;
}

const InstanceResult* QueryResult::find_instance(const MemoryId& id) const {
  const SnapshotResult* snapshot = id.index() ? find_snapshot(id) : nullptr;
  return snapshot != nullptr ? snapshot->find(*id.index()) : nullptr;
}

bool QueryResult::contains(const MemoryId& id) const {
  if (id.index()) return find_instance(id) != nullptr;
  if (id.time()) return find_snapshot(id) != nullptr;
  return has_names(memories_, std::span<const std::string>(id.names()));
}

std::vector<MemoryId> QueryResult::ids() const {
  std::vector<MemoryId> ids;
  for (const EntityResult* entity : entities()) append_ids(*entity, ids);
  return ids;
}

size_t QueryResult::snapshot_count() const {
  size_t count = 0;
  for (const EntityResult* entity : entities()) count += entity->snapshots.size();
  return count;
}

size_t QueryResult::size_bytes() const {
  if (is_ids_only_) return 0;
  size_t total = 0;
  for (const EntityResult* entity : entities())
    for (const SnapshotResult& snapshot : entity->snapshots)
      for (const InstanceResult& instance : snapshot.instances)
        total += idf::encoded_size(instance.data);
  return total;
}

}  // namespace engram::ltm
