// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <pybind11/pybind11.h>

#include "ltm/memory/commit.h"

namespace engram::python {

/// Converts updates from Python to one commit. Each is a dict with "entity", "time" (ns) and
/// "instances", a list of dicts with "value", "created" and "sent" (ns; None: the same as "time"),
/// "provider" and "confidence". Arrays are copied. Needs the GIL.
/// Errors: engram.errors.InvalidArgumentError naming the entity, what was found and what was
/// needed; any exception that `to_idf` of a value raises.
[[nodiscard]] ltm::Commit commit_of(const pybind11::list& updates);

/// Parses the name of one entity, which has four parts.
/// Errors: kInvalidArgument.
[[nodiscard]] Result<ltm::MemoryId> entity_of(const std::string& name);

}  // namespace engram::python
