// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/idf/type.h"

namespace engram::idf {

/// Maps the keys of the data to Python names.
using PythonNames = std::unordered_map<std::string, std::string>;

/// ASCII letters, digits and `_`, with no digit first.
[[nodiscard]] bool is_python_identifier(std::string_view name);

/// "Cup" for "kitchen::Cup", with `_` appended where Python or generated code uses the word.
[[nodiscard]] std::string python_class_name(std::string_view type_name);

/// "kitchen.Thing" for "kitchen/Thing.xml". Characters other than letters, digits and underscores
/// become `_`.
/// Errors: kInvalidArgument where the name leads out of its directory.
Result<std::string> python_module_name(std::string_view xml_name);

/// The attributes of all members, those of the base included. They depend on the type alone, so
/// that a derived class has those of its base, wherever it is generated.
/// Errors: kInvalidArgument for a key that is no identifier.
Result<PythonNames> python_attributes(const types::Object& object);

/// The Python names of the values of an enum. Errors: those of python_attributes.
Result<PythonNames> python_enum_names(const types::IntEnum& type);

}  // namespace engram::idf
