// SPDX-License-Identifier: Apache-2.0
#include "memory/memory.h"

namespace engram {

Result<ltm::QueryResult> Memory::query(std::string_view query, const std::string& engine) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query parsed, ltm::Query::parse(query));
  return this->query(parsed, engine);
}

Status Memory::query_parts(const ltm::Query& query, const PartVisit& visit,
                           const std::string& engine) {
  ENGRAM_ASSIGN_OR_RETURN(ltm::QueryResult whole, this->query(query, engine));
  return visit(std::move(whole));
}

Result<ltm::MomentMap> Memory::map(const ltm::MemoryId& entity, size_t /*max_moments*/) {
  return failed_precondition(
      "entity '{}': servers make no maps; open the store of this memory instead",
      entity.to_string());
}

Result<ltm::SalientMoment> Memory::why_salient(const ltm::MemoryId& entity,
                                               std::optional<Time> /*time*/) {
  return failed_precondition(
      "entity '{}': servers do not explain saliency; open the store of this memory instead",
      entity.to_string());
}

Result<std::vector<ltm::SnapshotResult>> Memory::predict(const ltm::MemoryId& entity,
                                                         std::span<const Duration> horizons,
                                                         const std::string& engine) {
  return predict(entity, horizons, PredictOptions{{}, {}, engine});
}

Result<std::vector<ltm::SnapshotResult>> Memory::predict(const ltm::MemoryId& entity,
                                                         std::span<const Duration> horizons,
                                                         const PredictOptions& options) {
  if (!entity.has_entity() || entity.time())
    return invalid_argument("'{}': needs the ID of an entity", entity.to_string());
  if (horizons.empty())
    return invalid_argument("entity '{}': found no horizon to predict, needs one",
                            entity.to_string());
  std::vector<ltm::Selector> selectors;
  for (const Duration ahead : horizons) {
    if (ahead <= Duration(0))
      return invalid_argument("entity '{}': found a horizon of {}, needs more than zero",
                              entity.to_string(), to_string(ahead));
    selectors.emplace_back(ltm::select::Ahead{ahead});
  }
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query asked, ltm::Query::of_entity(entity, selectors));
  if (options.at || options.plan) return predict_from(entity, horizons, options);
  // A plain query, because servers of all versions answer it.
  ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult answer, query(asked, options.engine));
  const ltm::EntityResult* found = answer.find_entity(entity);
  std::vector<ltm::SnapshotResult> predicted;
  for (const Duration ahead : horizons) {
    const ltm::SnapshotResult* one = nullptr;
    if (found != nullptr)
      for (const ltm::SnapshotResult& snapshot : found->snapshots)
        if (snapshot.horizon == ahead) one = &snapshot;
    if (one == nullptr)
      return not_found("entity '{}': has no snapshot to predict from", entity.to_string());
    predicted.push_back(*one);
  }
  return predicted;
}

}  // namespace engram
