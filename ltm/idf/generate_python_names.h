// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/idf/type.h"

namespace engram::idf {

/// Python's names by the keys of the data.
using PythonNames = std::unordered_map<std::string, std::string>;

/// Letters of ASCII, digits and `_`, no digit first.
[[nodiscard]] bool is_python_identifier(std::string_view name);

/// "Cup" of "kitchen::Cup"; with `_` behind it where Python or generated code has that word.
[[nodiscard]] std::string python_class_name(std::string_view type_name);

/// "kitchen.Thing" of "kitchen/Thing.xml". What is no letter, digit or underscore becomes `_`.
/// Errors: kInvalidArgument where the name leads out of its directory.
Result<std::string> python_module_name(std::string_view xml_name);

/// The attributes of all members, those of the base included. They follow from the type alone, so
/// that a derived class, wherever it is generated, has those of its base.
/// Errors: kInvalidArgument for a key that is no identifier.
Result<PythonNames> python_attributes(const types::Object& object);

/// Errors: as above.
Result<PythonNames> python_enum_names(const types::IntEnum& type);

}  // namespace engram::idf
