// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/recordings/recording_format.h"

namespace engram::datasets {

// What imports stored about the entities, for code that exports them. Errors: those of Recall.

/// Returns true if an entity describes recordings and is not itself part of one.
[[nodiscard]] bool is_description(const ltm::MemoryId& entity);

/// Returns true if the entity describes a stream of `format`.
[[nodiscard]] bool is_stream_description(const ltm::MemoryId& entity, std::string_view format);

/// Returns the newest snapshot of an entity; nothing if it has none.
Result<std::optional<ltm::SnapshotResult>> newest_snapshot(ltm::Recall& recall,
                                                           const ltm::MemoryId& entity,
                                                           const ltm::Recall::Options& options);

/// Returns the description of the entity that an import of `format` stored; nothing if none did.
Result<std::optional<RecordingStream>> stored_stream(ltm::Recall& recall, std::string_view format,
                                                     const ltm::MemoryId& entity,
                                                     const ltm::Recall::Options& options);

/// Returns the streams of `format` without a value whose entities the query matches.
Result<std::vector<RecordingStream>> empty_streams(ltm::Recall& recall, std::string_view format,
                                                   const ltm::Query& query,
                                                   const ltm::Recall::Options& options);

/// Returns the topic name of an entity that no import made: "/Vision/RGB/head/cam".
[[nodiscard]] std::string topic_of_entity(const ltm::MemoryId& entity);

/// Counts in `not_held` what no message format can hold of a snapshot: instances beyond the first,
/// confidence, and the origin of augmented values.
void tell_metadata(const ltm::SnapshotResult& snapshot,
                   std::map<std::string, uint64_t, std::less<>>& not_held);

}  // namespace engram::datasets
