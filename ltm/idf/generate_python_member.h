// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ltm/idf/type.h"

namespace engram::idf {

/// The hint of an attribute of `type`, for people and type checkers: "NDArray[np.uint8] | None".
[[nodiscard]] std::string python_hint(const Type& type);

/// The documentation of a member, then the facts of its type on a line of their own: "Where it is."
/// and "Unit: m. Range: 0..1.".
[[nodiscard]] std::string python_member_doc(const Member& member);

}  // namespace engram::idf
