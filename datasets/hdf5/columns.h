// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the assignment of members of a store's values to arrays.

#include <map>

#include "datasets/hdf5/dialect.h"
#include "ltm/recall/recall.h"

namespace engram::datasets {

using NotHeld = std::map<std::string, uint64_t, std::less<>>;

/// One member of an entity's values, which becomes one array.
struct Column {
  std::string member;   ///< Path in the value: "values", "pose/position".
  std::string name;     ///< The name of the array in an episode's group.
  RowForm form;         ///< The form of the values.
  h5::ArrayInfo array;  ///< The layout of the array in the file, for a single row.
};

struct ExportedEntity {
  ltm::MemoryId entity;
  std::vector<Column> columns;
};

/// Returns the entities of a query that can be written as arrays, judged by the newest value of
/// each; all others are counted in `not_held`. Arrays get the names, types and chunks of the file
/// that they came from, if the store knows it.
/// Errors: those of exported_entities and Recall.
Result<std::vector<ExportedEntity>> exported_columns(ltm::Recall& recall, const ltm::Query& query,
                                                     const ltm::Recall::Options& options,
                                                     const Dialect& dialect, NotHeld& not_held);

/// Returns the episodes that an import of this format left in the store, in the order of time; one
/// episode with everything if there are none.
Result<std::vector<RecordingEpisode>> stored_episodes(ltm::Recall& recall, const Dialect& dialect);

}  // namespace engram::datasets
