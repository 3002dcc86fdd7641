// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/recordings/recording_format.h"

namespace engram::datasets {

// What imports left in a store about its entities, for whoever writes them. Errors: those of
// Recall.

/// Whether an entity describes recordings, and is no part of them.
[[nodiscard]] bool is_description(const ltm::MemoryId& entity);

/// Whether it describes a stream of `format`.
[[nodiscard]] bool is_stream_description(const ltm::MemoryId& entity, std::string_view format);

/// The newest snapshot of an entity; nothing where it has none.
Result<std::optional<ltm::SnapshotResult>> newest_snapshot(ltm::Recall& recall,
                                                           const ltm::MemoryId& entity,
                                                           const ltm::Recall::Options& options);

/// What an import of `format` said of the entity; nothing where none did.
Result<std::optional<RecordingStream>> stored_stream(ltm::Recall& recall, std::string_view format,
                                                     const ltm::MemoryId& entity,
                                                     const ltm::Recall::Options& options);

/// Streams of `format` without a value, whose entities the query matches.
Result<std::vector<RecordingStream>> empty_streams(ltm::Recall& recall, std::string_view format,
                                                   const ltm::Query& query,
                                                   const ltm::Recall::Options& options);

/// What a file calls an entity that no import made: "/Vision/RGB/head/cam".
[[nodiscard]] std::string topic_of_entity(const ltm::MemoryId& entity);

/// What no format of messages holds of a snapshot: instances beyond the first, confidence, where
/// augmented values come from. Counted in `not_held`.
void tell_metadata(const ltm::SnapshotResult& snapshot,
                   std::map<std::string, uint64_t, std::less<>>& not_held);

}  // namespace engram::datasets
