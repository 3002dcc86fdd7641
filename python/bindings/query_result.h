// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <pybind11/pybind11.h>

#include <vector>

#include "ltm/memory/result.h"
#include "ltm/prediction/engine_choice.h"

namespace engram::python {

/// What engram.snapshot.Snapshot is made of: a list of dicts. Needs the GIL.
[[nodiscard]] pybind11::list snapshots_of(const ltm::MemoryId& entity,
                                          const std::vector<ltm::SnapshotResult>& of_entity);

/// What Memory.query is made of: a list of (entity, snapshots). Needs the GIL.
[[nodiscard]] pybind11::list answer_of(const ltm::QueryResult& result);

/// What engram.snapshot.Engine is made of: {"name", "model", "predictions", "error", "bound"} of
/// each, in their order. Needs the GIL.
[[nodiscard]] pybind11::list engines_of(const std::vector<ltm::EngineRecord>& records);

}  // namespace engram::python
