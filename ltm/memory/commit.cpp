// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/commit.h"

#include "ltm/memory/checked_snapshot.h"
#include "ltm/memory/data_fields.h"

namespace engram::ltm {

Status Commit::check() const {
  return check_updates(pointers_to(updates));
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
