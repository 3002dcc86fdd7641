// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <pybind11/pybind11.h>

#include <vector>

#include "ltm/memory/result.h"

namespace engram::python {

/// What engram.snapshot.Snapshot is made of: a list of dicts. Needs the GIL.
[[nodiscard]] pybind11::list snapshots_of(const ltm::MemoryId& entity,
                                          const std::vector<ltm::SnapshotResult>& of_entity);

}  // namespace engram::python
