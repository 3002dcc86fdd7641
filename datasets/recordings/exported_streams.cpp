// SPDX-License-Identifier: Apache-2.0
#include "datasets/recordings/exported_streams.h"

#include <algorithm>
#include <tuple>

#include "datasets/recordings/stored_streams.h"

namespace engram::datasets {

namespace {

constexpr uint64_t kSnapshotsPerProgress = 16;

bool is_named_before(const ExportedStream& a, const ExportedStream& b) {
  const auto size = [](const ExportedStream& stream) {
    return stream.entity.names().back().size();
  };
  return std::tuple(size(a), a.entity) < std::tuple(size(b), b.entity);
}

}  // namespace

void tell_description(NotHeld& not_held) {
  ++not_held["descriptions of other formats' streams"];
}

Status visit_exported(ltm::Recall& recall, const ltm::Query& query, std::string_view format,
                      std::string_view kindred, const ltm::Recall::Options& options,
                      NotHeld& not_held, const std::function<Status(ExportedStream)>& visit) {
  ENGRAM_ASSIGN_OR_RETURN(const auto entities, exported_entities(recall, query));
  std::vector<ExportedStream> streams;
  for (const ltm::MemoryId& entity : entities) {
    if (!is_description(entity))
      streams.push_back({entity, {}, {}, {}});
    else if (entity.names()[2] != format && !is_stream_description(entity, kindred))
      tell_description(not_held);
  }
  ENGRAM_ASSIGN_OR_RETURN(auto empty, empty_streams(recall, format, query, options));
  for (RecordingStream& stream : empty)
    streams.push_back({stream.entity, std::move(stream), {}, {}});
  ENGRAM_ASSIGN_OR_RETURN(empty, empty_streams(recall, kindred, query, options));
  for (RecordingStream& stream : empty)
    streams.push_back({stream.entity, {}, std::move(stream), {}});
  std::ranges::sort(streams, is_named_before);
  for (ExportedStream& stream : streams) {
    if (!stream.stored && !stream.kindred) {
      ENGRAM_ASSIGN_OR_RETURN(stream.newest, newest_snapshot(recall, stream.entity, options));
      if (!stream.newest || stream.newest->instances.empty()) continue;
      ENGRAM_ASSIGN_OR_RETURN(stream.stored, stored_stream(recall, format, stream.entity, options));
      ENGRAM_ASSIGN_OR_RETURN(stream.kindred,
                              stored_stream(recall, kindred, stream.entity, options));
      if (stream.stored) stream.kindred.reset();
    }
    ENGRAM_RETURN_IF_ERROR(visit(std::move(stream)));
  }
  return {};
}

Status write_snapshots(
    const ExportRequest& request, std::string_view format, ExportReport& report,
    const std::function<Status(const ltm::MemoryId&, const ltm::SnapshotResult&)>& write) {
  ENGRAM_ASSIGN_OR_RETURN(auto snapshots, MergedSnapshots::create(request.recall, request.query,
                                                                  request.options.recall));
  while (true) {
    if (request.stop.stop_requested())
      return cancelled("stopped after {} values", report.snapshots);
    ENGRAM_ASSIGN_OR_RETURN(const auto item, snapshots.next());
    if (!item) return {};
    if (is_description(item->entity)) continue;
    ++report.snapshots;
    ENGRAM_RETURN_IF_ERROR(write(item->entity, item->snapshot));
    if (request.progress && report.snapshots % kSnapshotsPerProgress == 0)
      request.progress({.what = fmt::format("export {}", format),
                        .done = report.snapshots,
                        .total = 0,
                        .detail = to_string(item->snapshot.time)});
  }
}

const ltm::InstanceResult* message_instance(const ltm::SnapshotResult& snapshot,
                                            ExportReport& report) {
  if (snapshot.instances.empty()) return nullptr;
  if (snapshot.instances.size() > 1)
    report.not_carried["instances beyond the first of a snapshot"] += snapshot.instances.size() - 1;
  if (to_ns(snapshot.time) >= 0) return &snapshot.instances.front();
  ++report.not_carried["values before 1970"];
  return nullptr;
}

void tell_misfit(const ltm::MemoryId& entity, ExportReport& report) {
  ++report.not_carried[fmt::format("values of '{}' that are no messages of its type",
                                   entity.to_string())];
}

}  // namespace engram::datasets
