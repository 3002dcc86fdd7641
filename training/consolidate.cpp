// SPDX-License-Identifier: Apache-2.0
#include "training/consolidate.h"

#include <algorithm>

#include "ltm/memory/query.h"
#include "ltm/store/store_reader.h"
#include "training/entity_job.h"

namespace engram::training {

namespace {

Result<std::vector<ltm::MemoryId>> matching(const ltm::StoreReader& reader,
                                            const std::vector<std::string>& texts) {
  std::vector<ltm::Query> queries;
  for (const std::string& text : texts) {
    ENGRAM_ASSIGN_OR_RETURN(ltm::Query query, ltm::Query::parse(text));
    queries.push_back(std::move(query));
  }
  std::vector<ltm::MemoryId> entities;
  for (const ltm::MemoryId& entity : reader.entities())
    if (queries.empty() || std::any_of(queries.begin(), queries.end(),
                                       [&](const auto& query) { return query.matches(entity); }))
      entities.push_back(entity);
  if (entities.empty())
    return not_found("store '{}': none of its {} entities matches", reader.path().string(),
                     reader.entities().size());
  return entities;
}

}  // namespace

Status ConsolidateOptions::validate() const {
  if (min_snapshots < 2)
    return invalid_argument("smallest number of snapshots: found {}, needs 2", min_snapshots);
  ENGRAM_RETURN_IF_ERROR(representation.validate());
  return train.validate();
}

Result<ConsolidateReport> consolidate(const std::filesystem::path& store,
                                      const ConsolidateOptions& options,
                                      const ProgressSink& progress, const std::stop_token& stop) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, ltm::StoreReader::open(store));
  ENGRAM_ASSIGN_OR_RETURN(const auto entities, matching(*reader, options.entities));
  std::vector<EntityJob> jobs;
  double total_weight = 0;
  for (const ltm::MemoryId& entity : entities) {
    EntityJob& job = jobs.emplace_back(*reader, entity, options, progress, stop);
    ENGRAM_RETURN_IF_ERROR(job.plan());
    total_weight += job.weight();
  }
  ConsolidateReport report;
  for (EntityJob& job : jobs) {
    const double share = total_weight > 0 ? job.weight() / total_weight : 0;
    ENGRAM_ASSIGN_OR_RETURN(const Duration budget,
                            duration_from_seconds(to_seconds(options.train.budget) * share));
    ENGRAM_ASSIGN_OR_RETURN(EntityReport one, job.run(budget));
    report.entities.push_back(std::move(one));
  }
  return report;
}

}  // namespace engram::training
