// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ltm/idf/type.h"

namespace engram::idf {

/// "NDArray[np.uint8] | None": what an attribute of `type` is, for people and checkers.
[[nodiscard]] std::string python_hint(const Type& type);

/// "Where it is.\nUnit: m. Range: 0..1.": what people wrote, then what the type says.
[[nodiscard]] std::string python_member_doc(const Member& member);

}  // namespace engram::idf
