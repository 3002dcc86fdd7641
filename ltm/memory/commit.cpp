// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/commit.h"

#include <unordered_set>

#include "ltm/memory/data_fields.h"

namespace engram::ltm {

Status Commit::check() const {
  std::unordered_set<MemoryId> seen;
  for (const EntityUpdate& update : updates) {
    if (!update.entity.is_entity())
      return invalid_argument("commit: '{}' is no entity: needs four names",
                              update.entity.to_string());
    if (update.instances.empty())
      return invalid_argument("commit: '{}' has no instance, needs at least one",
                              update.id().to_string());
    if (updates.size() > 1 && !seen.insert(update.id()).second)
      return invalid_argument("commit: has '{}' twice, needs each entity and time once",
                              update.id().to_string());
  }
  return {};
}

idf::Data Commit::to_data() const {
  idf::List list;
  list.reserve(updates.size());
  for (const EntityUpdate& update : updates) list.push_back(update.to_data());
  return idf::Dict{{"updates", std::move(list)}};
}

Result<Commit> Commit::from_data(const idf::Data& data) {
  ENGRAM_ASSIGN_OR_RETURN(const DataFields fields, DataFields::of(data, "commit"));
  ENGRAM_ASSIGN_OR_RETURN(const idf::List* list, fields.list("updates"));
  Commit commit;
  commit.updates.reserve(list->size());
  for (size_t i = 0; i < list->size(); ++i) {
    auto update = EntityUpdate::from_data((*list)[i]);
    if (!update.ok()) return update.status().with_context(fmt::format("commit: update {}", i));
    commit.updates.push_back(*std::move(update));
  }
  return commit;
}

}  // namespace engram::ltm
