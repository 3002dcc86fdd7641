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

/// The initial value of such a member, which is idf::default_value; empty where C++ initialises a
/// member of a struct with it anyway.
[[nodiscard]] std::string cpp_initial(const Type& type, std::string_view scope);

/// An expression that creates the type; `idf` names engram::idf.
[[nodiscard]] CodeExpression cpp_factory(const Type& type, std::string_view scope);

/// Like cpp_factory, but an object or enum is spelled out instead of named.
[[nodiscard]] CodeExpression cpp_definition(const Type& type, std::string_view scope);

/// The facts of a type for a comment besides its documentation: "Unit: m. Range: 0..1.".
[[nodiscard]] std::string cpp_facts(const Type& type);

/// The headers that code with such a member needs; `sources` are needed by conversions only.
struct CppHeaders {
  std::set<std::string> system;
  std::set<std::string> libraries;
  std::set<std::string> own;
  std::set<std::string> sources;

  void add(const Type& type);
};

}  // namespace engram::idf
