// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "datasets/recordings/snapshot_cursor.h"
#include "ltm/recall/recall.h"

namespace engram::datasets {

/// Returns the entities of a store that a query selects.
/// Errors: kNotFound if there is none; kInvalidArgument if the query asks only for IDs.
Result<std::vector<ltm::MemoryId>> exported_entities(ltm::Recall& recall, const ltm::Query& query);

/// Recalls one snapshot and decodes it.
Result<std::optional<ltm::SnapshotResult>> recalled_snapshot(ltm::Recall& recall,
                                                             const ltm::MemoryId& entity,
                                                             const SnapshotCursor::Step& step,
                                                             const ltm::Recall::Options& options);

/// The snapshots that a query selects, of all entities, in the order of time and, at equal times,
/// of names. They are decoded one by one, so memory is bounded by the largest snapshot. Predictions
/// are left out.
///
/// Threading: one thread. `recall` must outlive it.
class MergedSnapshots {
 public:
  /// Errors: those of exported_entities and of Recall. next() fails with those of Recall.
  static Result<MergedSnapshots> create(ltm::Recall& recall, const ltm::Query& query,
                                        const ltm::Recall::Options& options);

  struct Item {
    ltm::MemoryId entity;
    ltm::SnapshotResult snapshot;
  };
  Result<std::optional<Item>> next();

 private:
  struct Source {
    ltm::MemoryId entity;
    SnapshotCursor cursor;
    std::optional<SnapshotCursor::Step> step;  ///< The next one.
  };

  MergedSnapshots(ltm::Recall& recall, const ltm::Recall::Options& options)
      : recall_(&recall), options_(options) {}

  static Status advance(Source& source);

  ltm::Recall* recall_;
  ltm::Recall::Options options_;
  std::vector<Source> sources_;
};

}  // namespace engram::datasets
