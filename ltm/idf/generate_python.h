// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/core/status.h"
#include "ltm/idf/generated_file.h"
#include "ltm/idf/type_xml.h"

namespace engram::idf {

/// Generates Python classes for the types that `file` defines: one module, "types.py" for
/// types.xml.
///
/// Objects become dataclasses over engram.idf.TypedObject, and enums become enum.IntEnum, each
/// under the last part of its name. Included types are imported from the modules generated from
/// their files: "kitchen/Thing.xml" is the module kitchen.Thing. A member or value whose key is a
/// word of Python, or one of the generated code, gets `_` appended.
///
/// The same file always gives the same text.
/// Errors: kInvalidArgument where two types become one class, a name or key is no identifier, the
/// name of an include leads out of its directory, or a type is used that the file does not know.
/// Source: docs/idf.md, section "Python".
Result<std::vector<GeneratedFile>> generate_python(const TypeFile& file);

}  // namespace engram::idf
