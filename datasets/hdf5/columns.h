// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what of a store becomes which array.

#include <map>

#include "datasets/hdf5/dialect.h"
#include "ltm/recall/recall.h"

namespace engram::datasets {

using NotHeld = std::map<std::string, uint64_t, std::less<>>;

/// One member of an entity's values, which becomes one array.
struct Column {
  std::string member;   ///< Path in the value: "values", "pose/position".
  std::string name;     ///< Of the array in an episode's group.
  RowForm form;         ///< Of the values.
  h5::ArrayInfo array;  ///< Of a single row; what its rows are like in the file.
};

struct ExportedEntity {
  ltm::MemoryId entity;
  std::vector<Column> columns;
};

/// The entities of a query that can be arrays, by the newest value of each; what cannot is counted
/// in `not_held`. Arrays get the names, types and chunks of the file that they came from, where the
/// store knows it.
/// Errors: those of exported_entities and Recall.
Result<std::vector<ExportedEntity>> exported_columns(ltm::Recall& recall, const ltm::Query& query,
                                                     const ltm::Recall::Options& options,
                                                     const Dialect& dialect, NotHeld& not_held);

/// The episodes that an import of this format left in the store, in the order of time; one that
/// has everything where there are none.
Result<std::vector<RecordingEpisode>> stored_episodes(ltm::Recall& recall, const Dialect& dialect);

}  // namespace engram::datasets
