// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "datasets/recordings/snapshot_cursor.h"
#include "ltm/recall/recall.h"

namespace engram::datasets {

/// The entities of a store that a query asks for.
/// Errors: kNotFound where none does; kInvalidArgument where the query asks for IDs alone.
Result<std::vector<ltm::MemoryId>> exported_entities(ltm::Recall& recall, const ltm::Query& query);

/// One snapshot, decoded.
Result<std::optional<ltm::SnapshotResult>> recalled_snapshot(ltm::Recall& recall,
                                                             const ltm::MemoryId& entity,
                                                             const SnapshotCursor::Step& step,
                                                             const ltm::Recall::Options& options);

/// What a query asks for of several entities, in the order of time and, at one time, of names;
/// decoded one by one: memory is bounded by the largest. Predictions are left out.
///
/// Threading: one thread. `recall` must outlive it.
class MergedSnapshots {
 public:
  /// Errors: those of exported_entities; here and below, those of Recall.
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
