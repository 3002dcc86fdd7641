// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string_view>

#include "datasets/recordings/merged_snapshots.h"
#include "datasets/recordings/recording_format.h"

namespace engram::datasets {

// Code that writers of message formats share. In these formats each entity is one stream.

/// One entity that is written to the file.
struct ExportedStream {
  ltm::MemoryId entity;
  /// The description that an import of this format stored; empty if there is none.
  std::optional<RecordingStream> stored;
  /// The description that an import of the kindred format stored, if `stored` is empty.
  std::optional<RecordingStream> kindred;
  /// The newest snapshot, with at least one instance; empty if the stream was imported without a
  /// value.
  std::optional<ltm::SnapshotResult> newest;
};

/// The result of RecordingFormat::not_held.
using NotHeld = std::map<std::string, uint64_t, std::less<>>;

/// The arguments of RecordingFormat::write; all of them must outlive this.
struct ExportRequest {
  ltm::Recall& recall;
  const ltm::Query& query;
  const WritingOptions& options;
  const ProgressSink& progress;
  const std::stop_token& stop;
};

/// Visits, one by one, the entities with values that a query selects, and the streams that imports
/// found empty, in the order in which imports assign names: "text", "text_2", "text_10".
/// `kindred` is another format whose streams can be written as well. Descriptions by other formats
/// are counted in `not_held`; a caller that cannot use a kindred one calls tell_description.
/// Errors: those of exported_entities, Recall and `visit`.
Status visit_exported(ltm::Recall& recall, const ltm::Query& query, std::string_view format,
                      std::string_view kindred, const ltm::Recall::Options& options,
                      NotHeld& not_held, const std::function<Status(ExportedStream)>& visit);

/// Counts a description that an import of another format stored for a stream.
void tell_description(NotHeld& not_held);

/// Passes the selected snapshots, without descriptions, to `write` in the order of time, and counts
/// them. `format` is shown in progress reports.
/// Errors: kCancelled after a stop; those of MergedSnapshots and `write`.
Status write_snapshots(
    const ExportRequest& request, std::string_view format, ExportReport& report,
    const std::function<Status(const ltm::MemoryId&, const ltm::SnapshotResult&)>& write);

/// Returns the instance of a snapshot that becomes a message, or null if there is none. Further
/// instances, and times before 1970, are counted as not carried.
[[nodiscard]] const ltm::InstanceResult* message_instance(const ltm::SnapshotResult& snapshot,
                                                          ExportReport& report);

/// Counts a value that the type of its stream cannot hold.
void tell_misfit(const ltm::MemoryId& entity, ExportReport& report);

}  // namespace engram::datasets
