// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/core/status.h"
#include "ltm/idf/generate_python_text.h"
#include "ltm/idf/type_xml.h"

namespace engram::idf {

/// The call that creates the mirror (engram.idf.types) of an Object or IntEnum that `file` defines.
/// Objects and enums inside it are referred to by their classes.
/// Errors: kInvalidArgument where it uses a type that `file` does not know.
Result<PythonExpression> python_type(const Type& definition, const TypeFile& file);

}  // namespace engram::idf
