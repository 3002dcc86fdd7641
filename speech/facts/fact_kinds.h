// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what a value tells of, by its members.

#include "ltm/idf/data.h"

namespace engram::speech {

/// What values of one provider segment tell of.
enum class FactKind {
  kNothing,
  kExecution,
  kRefusal,
  kWords,
  kPlan,
  kThingClass,
  kThing,
  kSurface,
  kLocation,
  kDriveNote,
  kRobot,
};

/// Reads it from the members that a value has, whatever its type is called.
[[nodiscard]] FactKind fact_kind(const idf::Data& value);

}  // namespace engram::speech
