// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <pybind11/pybind11.h>

#include <vector>

#include "ltm/memory/result.h"
#include "ltm/prediction/engine_choice.h"

namespace engram::python {

/// The dicts from which engram.snapshot.Snapshot is built. Needs the GIL.
[[nodiscard]] pybind11::list snapshots_of(const ltm::MemoryId& entity,
                                          const std::vector<ltm::SnapshotResult>& of_entity);

/// The list of (entity, snapshots) from which the result of Memory.query is built. Needs the GIL.
[[nodiscard]] pybind11::list answer_of(const ltm::QueryResult& result);

/// The times of the snapshots that an answer has of an entity. Unit: ns.
[[nodiscard]] std::vector<int64_t> times_in(const ltm::QueryResult& answer,
                                            const ltm::MemoryId& entity);

/// The dicts {"name", "model", "predictions", "error", "bound"} from which engram.snapshot.Engine
/// is built, in the order of `records`. Needs the GIL.
[[nodiscard]] pybind11::list engines_of(const std::vector<ltm::EngineRecord>& records);

}  // namespace engram::python
