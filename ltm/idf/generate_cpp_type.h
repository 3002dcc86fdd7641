// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <string_view>

#include "ltm/idf/generate_cpp_text.h"
#include "ltm/idf/type.h"

namespace engram::idf {

/// The C++ type of a value, as code in the namespace `scope` names it: "std::vector<Cup>".
[[nodiscard]] std::string cpp_type(const Type& type, std::string_view scope);

/// What such a value starts as, as idf::default_value says; empty where C++ starts it so by itself
/// when it is a member of a struct.
[[nodiscard]] std::string cpp_initial(const Type& type, std::string_view scope);

/// The expression that makes the type; `idf` names engram::idf.
[[nodiscard]] CodeExpression cpp_factory(const Type& type, std::string_view scope);

/// The same, spelled out where `type` is an object or an enum instead of naming it.
[[nodiscard]] CodeExpression cpp_definition(const Type& type, std::string_view scope);

/// What a comment says about a value beside its documentation: "Unit: m. Range: 0..1.".
[[nodiscard]] std::string cpp_facts(const Type& type);

/// Headers that code with such a member needs; `sources` are those that only conversions need.
struct CppHeaders {
  std::set<std::string> system;
  std::set<std::string> libraries;
  std::set<std::string> own;
  std::set<std::string> sources;

  void add(const Type& type);
};

}  // namespace engram::idf
