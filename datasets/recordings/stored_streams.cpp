// SPDX-License-Identifier: Apache-2.0
#include "datasets/recordings/stored_streams.h"

#include <algorithm>

#include "datasets/recordings/merged_snapshots.h"

namespace engram::datasets {

namespace {

bool has_entity(ltm::Recall& recall, const ltm::MemoryId& entity) {
  const auto known = recall.store().entities();
  return std::ranges::find(known, entity) != known.end();
}

Result<std::optional<RecordingStream>> stream_at(ltm::Recall& recall, const ltm::MemoryId& about,
                                                 const ltm::Recall::Options& options) {
  ENGRAM_ASSIGN_OR_RETURN(const auto snapshot, newest_snapshot(recall, about, options));
  if (!snapshot || snapshot->instances.empty()) return std::optional<RecordingStream>();
  auto stream = RecordingStream::from_data(snapshot->instances.front().data);
  return stream.ok() ? std::optional(*std::move(stream)) : std::nullopt;
}

}  // namespace

bool is_description(const ltm::MemoryId& entity) {
  return entity.names()[0] == "Recording" &&
         (entity.names()[1] == "Streams" || entity.names()[1] == "Episodes");
}

bool is_stream_description(const ltm::MemoryId& entity, std::string_view format) {
  return is_description(entity) && entity.names()[1] == "Streams" && entity.names()[2] == format;
}

Result<std::optional<ltm::SnapshotResult>> newest_snapshot(ltm::Recall& recall,
                                                           const ltm::MemoryId& entity,
                                                           const ltm::Recall::Options& options) {
  ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, recall.store().timeline(entity));
  const auto last = timeline->last();
  if (!last) return std::optional<ltm::SnapshotResult>();
  ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline->at_or_before(*last));
  if (!entry) return std::optional<ltm::SnapshotResult>();
  return recalled_snapshot(recall, entity, {*entry, false, {}}, options);
}

Result<std::optional<RecordingStream>> stored_stream(ltm::Recall& recall, std::string_view format,
                                                     const ltm::MemoryId& entity,
                                                     const ltm::Recall::Options& options) {
  const ltm::MemoryId about = stream_entity(format, entity);
  if (!has_entity(recall, about)) return std::optional<RecordingStream>();
  ENGRAM_ASSIGN_OR_RETURN(auto stream, stream_at(recall, about, options));
  if (stream && stream->entity != entity) stream.reset();
  return stream;
}

Result<std::vector<RecordingStream>> empty_streams(ltm::Recall& recall, std::string_view format,
                                                   const ltm::Query& query,
                                                   const ltm::Recall::Options& options) {
  std::vector<RecordingStream> streams;
  for (const ltm::MemoryId& about : recall.store().entities()) {
    if (!is_stream_description(about, format)) continue;
    ENGRAM_ASSIGN_OR_RETURN(auto stream, stream_at(recall, about, options));
    if (stream && query.matches(stream->entity) && !has_entity(recall, stream->entity))
      streams.push_back(*std::move(stream));
  }
  return streams;
}

std::string topic_of_entity(const ltm::MemoryId& entity) {
  std::string topic;
  for (const std::string& name : entity.names()) topic += "/" + name;
  return topic;
}

void tell_metadata(const ltm::SnapshotResult& snapshot,
                   std::map<std::string, uint64_t, std::less<>>& not_held) {
  const ltm::InstanceMetadata& first = snapshot.instances.front().metadata;
  if (snapshot.instances.size() > 1) ++not_held["instances beyond the first of a snapshot"];
  if (first.confidence != 1.0F) ++not_held["confidence"];
  if (!first.recipe.empty() || first.origin.depth() > 0)
    ++not_held["origin and recipe of augmented values"];
}

}  // namespace engram::datasets
