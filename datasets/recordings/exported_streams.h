// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string_view>

#include "datasets/recordings/merged_snapshots.h"
#include "datasets/recordings/recording_format.h"

namespace engram::datasets {

// What formats of messages, one stream per entity, have in common when they are written.

/// One entity that a file will have.
struct ExportedStream {
  ltm::MemoryId entity;
  /// What an import of the format said of it; nothing where none did.
  std::optional<RecordingStream> stored;
  /// What an import of the kindred format said of it, where none of the format did.
  std::optional<RecordingStream> kindred;
  /// Has an instance; nothing where the stream came in without a value.
  std::optional<ltm::SnapshotResult> newest;
};

/// What RecordingFormat::not_held says.
using NotHeld = std::map<std::string, uint64_t, std::less<>>;

/// What RecordingFormat::write is given; all of it must outlive this.
struct ExportRequest {
  ltm::Recall& recall;
  const ltm::Query& query;
  const WritingOptions& options;
  const ProgressSink& progress;
  const std::stop_token& stop;
};

/// Hands over, one by one, the entities with values that a query asks for, and the streams that
/// imports found empty, in the order in which imports give names out: "text", "text_2", "text_10".
/// `kindred` is another format whose streams can be written as well. Descriptions of others are
/// counted in `not_held`; who cannot take over a kindred one calls tell_description.
/// Errors: those of exported_entities, Recall and `visit`.
Status visit_exported(ltm::Recall& recall, const ltm::Query& query, std::string_view format,
                      std::string_view kindred, const ltm::Recall::Options& options,
                      NotHeld& not_held, const std::function<Status(ExportedStream)>& visit);

/// Counts what an import of another format said of a stream.
void tell_description(NotHeld& not_held);

/// Hands over the snapshots that are asked for, without descriptions, in the order of time, and
/// counts them. `format` is for progress.
/// Errors: kCancelled after a stop; those of MergedSnapshots and `write`.
Status write_snapshots(
    const ExportRequest& request, std::string_view format, ExportReport& report,
    const std::function<Status(const ltm::MemoryId&, const ltm::SnapshotResult&)>& write);

/// The instance of a snapshot that becomes a message. Further ones, and times before 1970, are
/// counted as not carried. Null where none is left.
[[nodiscard]] const ltm::InstanceResult* message_instance(const ltm::SnapshotResult& snapshot,
                                                          ExportReport& report);

/// Counts a value that its stream's type cannot hold.
void tell_misfit(const ltm::MemoryId& entity, ExportReport& report);

}  // namespace engram::datasets
