// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: which snapshots are rows of which episode.

#include "datasets/hdf5/columns.h"
#include "datasets/recordings/snapshot_cursor.h"

namespace engram::datasets {

/// Walks over the times of several entities, episode by episode. Decodes nothing.
class EpisodeCursors {
 public:
  /// Errors: here and below, those of Timeline.
  static Result<EpisodeCursors> create(ltm::Recall& recall, const ltm::Query& query,
                                       const std::vector<ExportedEntity>& entities);

  /// The next time of an entity before `end`; nothing where there is none.
  [[nodiscard]] std::optional<SnapshotCursor::Step> peek(size_t entity, Time end) const;
  Status advance(size_t entity);

 private:
  struct Cursor {
    SnapshotCursor snapshots;
    std::optional<SnapshotCursor::Step> step;
  };
  std::vector<Cursor> cursors_;
};

/// One episode as it will be written.
struct EpisodeRows {
  RecordingEpisode episode;
  Time end{};                  ///< Where the next one begins.
  std::vector<uint64_t> rows;  ///< Of each entity; 0: none, or they do not fit.
  uint64_t longest = 0;
};

/// Finds out which entities have their values in step: the steps of an episode are the times of the
/// entity that has the most, and others must have a value at each of them, until they end. What
/// does not is counted in `not_held`, by entity.
/// Complexity: O(values), decoding none.
Result<std::vector<EpisodeRows>> plan_episodes(ltm::Recall& recall, const ltm::Query& query,
                                               const std::vector<ExportedEntity>& entities,
                                               const Dialect& dialect, NotHeld& not_held);

}  // namespace engram::datasets
