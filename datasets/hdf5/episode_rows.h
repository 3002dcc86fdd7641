// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the assignment of snapshots to rows of episodes.

#include "datasets/hdf5/columns.h"
#include "datasets/recordings/snapshot_cursor.h"

namespace engram::datasets {

/// Iterates over the times of several entities, episode by episode. Decodes nothing.
class EpisodeCursors {
 public:
  /// Errors, also of advance(): those of Timeline.
  static Result<EpisodeCursors> create(ltm::Recall& recall, const ltm::Query& query,
                                       const std::vector<ExportedEntity>& entities);

  /// Returns the next time of an entity before `end`; nothing if there is none.
  [[nodiscard]] std::optional<SnapshotCursor::Step> peek(size_t entity, Time end) const;
  Status advance(size_t entity);

 private:
  struct Cursor {
    SnapshotCursor snapshots;
    std::optional<SnapshotCursor::Step> step;
  };
  std::vector<Cursor> cursors_;
};

/// One episode that is to be written.
struct EpisodeRows {
  RecordingEpisode episode;
  Time end{};                  ///< The start of the next episode.
  std::vector<uint64_t> rows;  ///< Rows of each entity; 0 if it has none, or they do not fit.
  uint64_t longest = 0;
};

/// Finds out which entities have their values in step. The steps of an episode are the times of the
/// entity with the largest number of values; every other entity must have a value at each of them,
/// until it ends. Entities that do not are counted in `not_held`.
/// Complexity: O(values); none is decoded.
Result<std::vector<EpisodeRows>> plan_episodes(ltm::Recall& recall, const ltm::Query& query,
                                               const std::vector<ExportedEntity>& entities,
                                               const Dialect& dialect, NotHeld& not_held);

}  // namespace engram::datasets
