// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/idf/generate_python_text.h"
#include "ltm/idf/type.h"

namespace engram::idf {

/// The default of an attribute, which follows its `=`: "0.0", "field(default_factory=list)". It
/// equals default_value.
[[nodiscard]] PythonExpression python_default(const Type& type);

}  // namespace engram::idf
