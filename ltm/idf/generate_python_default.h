// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/idf/generate_python_text.h"
#include "ltm/idf/type.h"

namespace engram::idf {

/// "0.0", "field(default_factory=list)": what stands behind the `=` of an attribute, as
/// default_value says.
[[nodiscard]] PythonExpression python_default(const Type& type);

}  // namespace engram::idf
