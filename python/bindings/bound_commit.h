// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <pybind11/pybind11.h>

#include "ltm/memory/commit.h"

namespace engram::python {

/// Dicts with "entity", "time" (ns), "instances": of "value", "created", "sent" (ns, None: as
/// "time"), "provider", "confidence"; all of them in one commit. Arrays are copied. Needs the GIL.
/// Errors: engram.errors.InvalidArgumentError naming the entity, what was found and what was
/// needed; what `to_idf` of a value raises.
[[nodiscard]] ltm::Commit commit_of(const pybind11::list& updates);

/// The name of one entity, four names.
/// Errors: kInvalidArgument.
[[nodiscard]] Result<ltm::MemoryId> entity_of(const std::string& name);

}  // namespace engram::python
