// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the writer of all dialects.

#include "datasets/hdf5/episode_rows.h"

namespace engram::datasets {

/// The plan of an export. To make it, at most one value of each entity is decoded.
struct EpisodesPlan {
  std::vector<ExportedEntity> entities;
  std::vector<EpisodeRows> episodes;
  NotHeld not_held;
};

/// Errors: those of Recall.
Result<EpisodesPlan> plan_export(ltm::Recall& recall, const ltm::Query& query,
                                 const WritingOptions& options, const Dialect& dialect);

/// Implements RecordingFormat::write for every dialect. Memory: a chunk of each array of one
/// entity.
Result<ExportReport> write_episodes(ltm::Recall& recall, const ltm::Query& query,
                                    const std::filesystem::path& path,
                                    const WritingOptions& options, const Dialect& dialect,
                                    const ProgressSink& progress, const std::stop_token& stop);

}  // namespace engram::datasets
