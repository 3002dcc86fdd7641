// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/core/status.h"
#include "ltm/idf/type.h"

namespace engram::idf {

/// Ok where every value of `provider` can be read as one of `core` without loss: cast drops what
/// the core type does not know and keeps the rest exactly.
///
/// An object needs all members of the core type, each extending the member there, and may have
/// more. Otherwise the kinds are the same, but for widening numbers, any array where the core has
/// an NDArray, and an orientation where it has a quaternion. Element types are the same or
/// wider in the core; sizes are the same where the core fixes them; bounds lie within its bounds;
/// the unit is the same where the core names one; enum values are among its own; what may be absent
/// may be so there too. Documentation, and the names of objects and enums, do not matter.
/// Errors: kInvalidArgument naming the path, what was found and what was needed.
Status check_extends(const Type& provider, const Type& core);

[[nodiscard]] bool extends(const Type& provider, const Type& core);

}  // namespace engram::idf
