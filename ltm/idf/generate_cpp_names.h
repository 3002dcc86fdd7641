// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ltm/idf/type.h"

namespace engram::idf {

/// `name` with a '_' behind it where C++, a common macro or generated code has that name.
[[nodiscard]] std::string cpp_identifier(std::string_view name);

/// {"kitchen", "Cup"} for "kitchen::Cup": identifiers that C++ takes, the same in every file.
[[nodiscard]] std::vector<std::string> cpp_path(std::string_view type_name);

/// "kitchen" of {"kitchen", "Cup"}; empty outside of namespaces.
[[nodiscard]] std::string cpp_namespace(std::string_view type_name);

/// How code inside the namespace `scope` names the type: "Cup", or "::kitchen::Cup" from outside.
[[nodiscard]] std::string cpp_reference(std::string_view type_name, std::string_view scope);

/// The members' names in C++: those that the object itself adds, in its order.
/// Unlike each other, those of the base, and the types that they use.
[[nodiscard]] std::vector<std::string> cpp_members(const types::Object& object);

/// The enumerators' names in C++.
[[nodiscard]] std::vector<std::string> cpp_enumerators(const types::IntEnum& named);

}  // namespace engram::idf
