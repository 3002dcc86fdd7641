// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ltm/idf/type.h"

namespace engram::idf {

/// `name`, with a '_' appended where C++, a common macro or generated code uses it.
[[nodiscard]] std::string cpp_identifier(std::string_view name);

/// {"kitchen", "Cup"} for "kitchen::Cup": valid C++ identifiers, the same in every file.
[[nodiscard]] std::vector<std::string> cpp_path(std::string_view type_name);

/// "kitchen" for {"kitchen", "Cup"}; empty outside of namespaces.
[[nodiscard]] std::string cpp_namespace(std::string_view type_name);

/// The name of the type for code inside the namespace `scope`: "Cup", or "::kitchen::Cup" outside.
[[nodiscard]] std::string cpp_reference(std::string_view type_name, std::string_view scope);

/// The C++ names of the members that the object itself adds, in its order. They differ from each
/// other, from those of the base, and from the types that they use.
[[nodiscard]] std::vector<std::string> cpp_members(const types::Object& object);

/// The C++ names of the enumerators.
[[nodiscard]] std::vector<std::string> cpp_enumerators(const types::IntEnum& named);

}  // namespace engram::idf
