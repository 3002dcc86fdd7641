// SPDX-License-Identifier: Apache-2.0
#include "datasets/export.h"

#include "datasets/recordings/merged_snapshots.h"
#include "ltm/core/file.h"

namespace engram::datasets {

namespace {

class Exporter {
 public:
  Exporter(ltm::Recall& recall, const ltm::Recall::Options& options, SnapshotSink& sink,
           const ProgressSink& progress, std::stop_token stop)
      : recall_(recall),
        options_(options),
        sink_(sink),
        progress_(progress),
        stop_(std::move(stop)) {}

  Status run(const ltm::MemoryId& entity, const ltm::Query& query) {
    ENGRAM_RETURN_IF_ERROR(sink_.begin(entity));
    ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, recall_.store().timeline(entity));
    ENGRAM_ASSIGN_OR_RETURN(
        SnapshotCursor cursor,
        SnapshotCursor::create(*timeline, query.snapshots_of(entity),
                               recall_.listed(entity, query.named_entities().has_value())));
    while (!stop_.stop_requested()) {
      ENGRAM_ASSIGN_OR_RETURN(const auto step, cursor.next());
      if (!step) break;
      ENGRAM_RETURN_IF_ERROR(add(entity, *step));
      if (progress_)
        progress_({"export " + entity.to_string(), sink_.report().snapshots, 0,
                   to_string(step->entry.time)});
    }
    return {};
  }

 private:
  Status add(const ltm::MemoryId& entity, const SnapshotCursor::Step& step) {
    ENGRAM_ASSIGN_OR_RETURN(const auto found, recalled_snapshot(recall_, entity, step, options_));
    if (found) ENGRAM_RETURN_IF_ERROR(sink_.add(*found));
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
  ENGRAM_ASSIGN_OR_RETURN(const auto entities, exported_entities(recall, query));
  Exporter exporter(recall, options, sink, progress, stop);
  for (const ltm::MemoryId& entity : entities) {
    if (stop.stop_requested()) break;
    ENGRAM_RETURN_IF_ERROR(exporter.run(entity, query));
  }
  ENGRAM_RETURN_IF_ERROR(sink.finish());
  if (stop.stop_requested())
    return cancelled("export stopped after {} snapshots; all files are whole",
                     sink.report().snapshots);
  return {};
}

}  // namespace engram::datasets
