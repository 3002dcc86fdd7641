// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "ltm/forgetting/plan_forgetting.h"

namespace engram::ltm {

namespace {

/// Adds all snapshots below an ID, or the snapshot that it names. Adds nothing if there is none.
Status add_below(StoreReader& store, const MemoryId& id, ForgetSet& chosen) {
  for (const MemoryId& entity : store.entities()) {
    if (!(id.time() ? id.entity() == entity : id.is_prefix_of(entity))) continue;
    ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, store.timeline(entity));
    const auto choose = [&](const SnapshotEntry& entry) {
      chosen[entity].insert(entry.time);
      return Status();
    };
    ENGRAM_RETURN_IF_ERROR(id.time() ? timeline->for_each(*id.time(), *id.time(), choose)
                                     : timeline->for_each(choose));
  }
  return {};
}

Status add_answers(Recall& recall, const Query& query, ForgetSet& chosen) {
  ENGRAM_ASSIGN_OR_RETURN(const Query ids, Query::create(query.memories(), true));
  ENGRAM_ASSIGN_OR_RETURN(const QueryResult answer, recall.query(ids));
  for (const EntityResult* entity : answer.entities())
    for (const SnapshotResult& snapshot : entity->snapshots)
      if (snapshot.source != Source::kPredicted) chosen[entity->id].insert(snapshot.time);
  return {};
}

/// The selectors `before:` and `at-or-before:` of a query.
std::vector<select::Before> before_selectors(const Query& query) {
  std::vector<select::Before> found;
  for (const MemoryQuery& memory : query.memories())
    for (const CoreSegmentQuery& core : memory.below)
      for (const ProviderSegmentQuery& provider : core.below)
        for (const EntityQuery& entity : provider.below)
          for (const SnapshotQuery& snapshots : entity.below)
            if (const auto* before = std::get_if<select::Before>(&snapshots.selector))
              found.push_back(*before);
  return found;
}

}  // namespace

std::vector<std::string> notes_on_targets(const std::vector<std::string>& texts) {
  std::vector<std::string> notes;
  for (const std::string& text : texts) {
    const auto query = Query::parse(text);
    if (!query.ok() || text.find('@') == std::string::npos) continue;
    for (const select::Before& before : before_selectors(*query))
      notes.push_back(
          fmt::format("'{}' takes one snapshot of each entity, the last one {} that time; "
                      "'until:{}' takes everything up to it",
                      to_string(Selector(before)), before.is_inclusive ? "before or at" : "before",
                      engram::to_string(before.time)));
  }
  return notes;
}

Result<ForgetSet> find_forget_targets(Recall& recall, const std::vector<std::string>& texts) {
  ForgetSet chosen;
  for (const std::string& text : texts) {
    ForgetSet named;
    const auto id = MemoryId::parse(text);
    // The empty ID would be everything, which nobody means with an empty argument.
    if (id.ok() && id->depth() > 0) ENGRAM_RETURN_IF_ERROR(add_below(recall.store(), *id, named));
    if (named.empty() && text.find('@') != std::string::npos) {
      ENGRAM_ASSIGN_OR_RETURN(const Query query, Query::parse(text));
      ENGRAM_RETURN_IF_ERROR(add_answers(recall, query, named));
    } else if (!id.ok()) {
      return id.status();
    }
    if (named.empty())
      return not_found(
          "store '{}': '{}' names no snapshot; needs a memory ID, or a query with a selector as "
          "in 'Vision/.*/head/cam @ all'",
          recall.store().path().string(), text);
    for (const auto& [entity, times] : named) chosen[entity].insert_all(times);
  }
  return chosen;
}

}  // namespace engram::ltm
