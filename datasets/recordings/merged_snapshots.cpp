// SPDX-License-Identifier: Apache-2.0
#include "datasets/recordings/merged_snapshots.h"

#include <algorithm>
#include <tuple>

namespace engram::datasets {

Result<std::vector<ltm::MemoryId>> exported_entities(ltm::Recall& recall, const ltm::Query& query) {
  if (query.is_ids_only())
    return invalid_argument("query '{}' asks for IDs alone: an export needs data",
                            query.to_string());
  std::vector<ltm::MemoryId> entities;
  for (const ltm::MemoryId& id : recall.store().entities())
    if (query.matches(id)) entities.push_back(id);
  if (entities.empty() && !recall.store().entities().empty())
    return not_found("store '{}': no entity matches '{}'", recall.store().path().string(),
                     query.to_string());
  return entities;
}

Result<std::optional<ltm::SnapshotResult>> recalled_snapshot(ltm::Recall& recall,
                                                             const ltm::MemoryId& entity,
                                                             const SnapshotCursor::Step& step,
                                                             const ltm::Recall::Options& options) {
  const auto& names = entity.names();
  std::array<ltm::NamePattern, ltm::MemoryId::kNameLevels> patterns;
  for (size_t i = 0; i < names.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(patterns[i], ltm::NamePattern::name(names[i]));
  }
  const ltm::SnapshotQuery wanted{ltm::select::At{step.entry.time}, step.instances};
  ENGRAM_ASSIGN_OR_RETURN(
      const ltm::Query query,
      ltm::Query::create(
          {{patterns[0], {{patterns[1], {{patterns[2], {{patterns[3], {wanted}}}}}}}}}));
  ENGRAM_ASSIGN_OR_RETURN(ltm::QueryResult answer, recall.query(query, options));
  const ltm::EntityResult* found = answer.find_entity(entity);
  if (found == nullptr || found->snapshots.empty()) return std::optional<ltm::SnapshotResult>();
  return std::optional(found->snapshots.front());
}

Result<MergedSnapshots> MergedSnapshots::create(ltm::Recall& recall, const ltm::Query& query,
                                                const ltm::Recall::Options& options) {
  MergedSnapshots merged(recall, options);
  ENGRAM_ASSIGN_OR_RETURN(const auto entities, exported_entities(recall, query));
  const bool is_named = query.named_entities().has_value();
  for (const ltm::MemoryId& entity : entities) {
    ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, recall.store().timeline(entity));
    ENGRAM_ASSIGN_OR_RETURN(SnapshotCursor cursor,
                            SnapshotCursor::create(*timeline, query.snapshots_of(entity),
                                                   recall.listed(entity, is_named)));
    Source source{entity, std::move(cursor), std::nullopt};
    ENGRAM_RETURN_IF_ERROR(advance(source));
    if (source.step) merged.sources_.push_back(std::move(source));
  }
  return merged;
}

Status MergedSnapshots::advance(Source& source) {
  ENGRAM_ASSIGN_OR_RETURN(source.step, source.cursor.next());
  if (source.step && source.step->is_future) source.step.reset();
  return {};
}

Result<std::optional<MergedSnapshots::Item>> MergedSnapshots::next() {
  while (!sources_.empty()) {
    const auto earliest = std::ranges::min_element(sources_, {}, [](const Source& source) {
      return std::tuple(source.step->entry.time, source.entity);
    });
    const ltm::MemoryId entity = earliest->entity;
    ENGRAM_ASSIGN_OR_RETURN(auto snapshot,
                            recalled_snapshot(*recall_, entity, *earliest->step, options_));
    ENGRAM_RETURN_IF_ERROR(advance(*earliest));
    if (!earliest->step) sources_.erase(earliest);
    if (snapshot) return std::optional(Item{entity, *std::move(snapshot)});
  }
  return std::optional<Item>();
}

}  // namespace engram::datasets
