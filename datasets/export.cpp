// SPDX-License-Identifier: Apache-2.0
#include "datasets/export.h"

#include "datasets/export_walk.h"
#include "ltm/core/file.h"

namespace engram::datasets {

namespace {

/// The entities that a query asks for.
std::vector<ltm::MemoryId> matching(const ltm::StoreReader& store, const ltm::Query& query) {
  std::vector<ltm::MemoryId> ids;
  for (const ltm::MemoryId& id : store.entities())
    if (query.matches(id)) ids.push_back(id);
  return ids;
}

/// A query of exactly one snapshot.
Result<ltm::Query> query_of(const ltm::MemoryId& entity, const SnapshotWalk::Step& step) {
  const auto& names = entity.names();
  std::array<ltm::NamePattern, ltm::MemoryId::kNameLevels> patterns;
  for (size_t i = 0; i < names.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(patterns[i], ltm::NamePattern::name(names[i]));
  }
  const ltm::SnapshotQuery wanted{ltm::select::At{step.entry.time}, step.instances};
  return ltm::Query::create(
      {{patterns[0], {{patterns[1], {{patterns[2], {{patterns[3], {wanted}}}}}}}}});
}

class Exporter {
 public:
  Exporter(ltm::Recall& recall, const ltm::Recall::Options& options, SnapshotSink& sink,
           const ProgressSink& progress, std::stop_token stop)
      : recall_(recall),
        options_(options),
        sink_(sink),
        progress_(progress),
        stop_(std::move(stop)) {}

  Status run(const ltm::MemoryId& entity, const std::vector<ltm::SnapshotQuery>& queries) {
    ENGRAM_RETURN_IF_ERROR(sink_.begin(entity));
    ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, recall_.store().timeline(entity));
    ENGRAM_ASSIGN_OR_RETURN(SnapshotWalk walk, SnapshotWalk::create(*timeline, queries));
    while (!stop_.stop_requested()) {
      ENGRAM_ASSIGN_OR_RETURN(const auto step, walk.next());
      if (!step) break;
      ENGRAM_RETURN_IF_ERROR(add(entity, *step));
      if (progress_)
        progress_({"export " + entity.to_string(), sink_.report().snapshots, 0,
                   to_string(step->entry.time)});
    }
    return {};
  }

 private:
  Status add(const ltm::MemoryId& entity, const SnapshotWalk::Step& step) {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::Query query, query_of(entity, step));
    ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult answer, recall_.query(query, options_));
    const ltm::EntityResult* found = answer.find_entity(entity);
    if (found == nullptr) return {};
    for (const ltm::SnapshotResult& snapshot : found->snapshots)
      ENGRAM_RETURN_IF_ERROR(sink_.add(snapshot));
    return {};
  }

  ltm::Recall& recall_;
  const ltm::Recall::Options& options_;
  SnapshotSink& sink_;
  const ProgressSink& progress_;
  std::stop_token stop_;
};

}  // namespace

Status prepare_export(const std::filesystem::path& directory, bool may_have_files) {
  std::error_code error;
  if (std::filesystem::exists(directory, error) && !std::filesystem::is_directory(directory, error))
    return already_exists("'{}' is a file: an export needs a directory", directory.string());
  ENGRAM_RETURN_IF_ERROR(make_directories(directory));
  const bool is_empty = std::filesystem::is_empty(directory, error);
  if (error) return unavailable("'{}': {}", directory.string(), error.message());
  if (is_empty || may_have_files) return {};
  return already_exists("'{}' is not empty: files in it might be replaced", directory.string());
}

Status export_snapshots(ltm::Recall& recall, const ltm::Query& query,
                        const ltm::Recall::Options& options, SnapshotSink& sink,
                        const ProgressSink& progress, const std::stop_token& stop) {
  if (query.is_ids_only())
    return invalid_argument("query '{}' asks for IDs alone: an export needs data",
                            query.to_string());
  const std::vector<ltm::MemoryId> entities = matching(recall.store(), query);
  if (entities.empty() && !recall.store().entities().empty())
    return not_found("store '{}': no entity matches '{}'", recall.store().path().string(),
                     query.to_string());
  Exporter exporter(recall, options, sink, progress, stop);
  for (const ltm::MemoryId& entity : entities) {
    if (stop.stop_requested()) break;
    ENGRAM_RETURN_IF_ERROR(exporter.run(entity, query.snapshots_of(entity)));
  }
  ENGRAM_RETURN_IF_ERROR(sink.finish());
  if (stop.stop_requested())
    return cancelled("export stopped after {} snapshots; all files are whole",
                     sink.report().snapshots);
  return {};
}

}  // namespace engram::datasets
