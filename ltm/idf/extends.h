// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/core/status.h"
#include "ltm/idf/type.h"

namespace engram::idf {

/// Ok where every value of `provider` can be read as one of `core` without loss: cast drops members
/// that the core type does not know and keeps the rest exactly.
///
/// An object needs all members of the core type, each extending the member there, and may have
/// more. All other kinds must be equal, with three exceptions: numbers may be wider in the core, an
/// NDArray of the core admits any array, and a quaternion of the core admits an orientation.
/// Element types are equal or wider in the core; sizes are equal where the core fixes them; bounds
/// lie within the core's bounds; the unit is equal where the core names one; enum values are among
/// the core's; a member may be optional only if it is optional in the core. Documentation and the
/// names of objects and enums do not count.
/// Errors: kInvalidArgument naming the path, what was found and what was needed.
Status check_extends(const Type& provider, const Type& core);

[[nodiscard]] bool extends(const Type& provider, const Type& core);

}  // namespace engram::idf
