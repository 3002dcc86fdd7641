// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/core/status.h"
#include "ltm/idf/generated_file.h"
#include "ltm/idf/type_xml.h"

namespace engram::idf {

/// Generates C++ for the types that a file defines: `types.h` and `types.cpp` for types.xml.
///
/// Every object becomes a struct with its members, `idf_type`, `to_idf`, `from_idf` and `==`; every
/// enum becomes an enum class with `to_string` and `idf_type`. The sources build against
/// engram::typed. Included files are generated separately: the header includes "kitchen/Thing.h"
/// for kitchen/Thing.xml. The same file always gives the same text.
/// Source: docs/idf.md, section "Generated code".
/// Errors: kInvalidArgument where two types would have the same C++ name, or a file name is not
/// possible in an #include.
Result<std::vector<GeneratedFile>> generate_cpp(const TypeFile& file);

}  // namespace engram::idf
