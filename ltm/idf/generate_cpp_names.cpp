// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/generate_cpp_names.h"

#include <fmt/ranges.h>

#include <set>
#include <unordered_set>

namespace engram::idf {

namespace {

const std::unordered_set<std::string_view>& reserved_words() {
  static const std::unordered_set<std::string_view> kWords{
      // Keywords.
      "alignas", "alignof", "and", "and_eq", "asm", "auto", "bitand", "bitor", "bool", "break",
      "case", "catch", "char", "char8_t", "char16_t", "char32_t", "class", "compl", "concept",
      "const", "consteval", "constexpr", "constinit", "const_cast", "continue", "co_await",
      "co_return", "co_yield", "decltype", "default", "delete", "do", "double", "dynamic_cast",
      "else", "enum", "explicit", "export", "extern", "false", "float", "for", "friend", "goto",
      "if", "inline", "int", "long", "mutable", "namespace", "new", "noexcept", "not", "not_eq",
      "nullptr", "operator", "or", "or_eq", "private", "protected", "public", "register",
      "reinterpret_cast", "requires", "return", "short", "signed", "sizeof", "static",
      "static_assert", "static_cast", "struct", "switch", "template", "this", "thread_local",
      "throw", "true", "try", "typedef", "typeid", "typename", "union", "unsigned", "using",
      "virtual", "void", "volatile", "wchar_t", "while", "xor", "xor_eq", "final", "override",
      // Macros of compilers and of common headers.
      "assert", "errno", "linux", "unix", "major", "minor", "stdin", "stdout", "stderr", "emit",
      "signals", "slots", "NULL", "EOF", "TRUE", "FALSE", "NAN", "INFINITY", "HUGE_VAL", "OVERFLOW",
      "UNDERFLOW", "DOMAIN", "SING", "BUFSIZ", "RAND_MAX", "M_PI", "M_E",
      // Names in generated code.
      "int8_t", "int16_t", "int32_t", "int64_t", "uint8_t", "uint16_t", "uint32_t", "uint64_t",
      "idf_type", "to_idf", "from_idf", "for_each_member", "to_string", "idf", "data", "visit"};
  return kWords;
}

/// Namespaces that generated code names from within others.
bool is_library(std::string_view name) {
  return name == "std" || name == "cv" || name == "Eigen";
}

/// Collects the names of the objects and enums inside `type`, without those inside of them.
void find_named(const Type& type, std::set<std::string>& names) {
  if (!type.name().empty()) {
    names.insert(cpp_path(type.name()).back());
    return;
  }
  for (const Member& part : type.parts()) find_named(part.type, names);
}

std::string unlike(std::string name, std::set<std::string>& taken) {
  while (!taken.insert(name).second) name += '_';
  return name;
}

}  // namespace

std::string cpp_identifier(std::string_view name) {
  return reserved_words().contains(name) ? fmt::format("{}_", name) : std::string(name);
}

std::vector<std::string> cpp_path(std::string_view type_name) {
  std::vector<std::string> path;
  while (true) {
    const size_t end = type_name.find("::");
    const std::string_view name = type_name.substr(0, end);
    const bool is_last = end == std::string_view::npos;
    const bool hides_us = name == "engram" && (is_last || !path.empty());
    path.push_back(cpp_identifier(name));
    if (is_library(name) || hides_us) path.back() += '_';
    if (is_last) return path;
    type_name.remove_prefix(end + 2);
  }
}

std::string cpp_namespace(std::string_view type_name) {
  std::vector<std::string> path = cpp_path(type_name);
  path.pop_back();
  return fmt::format("{}", fmt::join(path, "::"));
}

std::string cpp_reference(std::string_view type_name, std::string_view scope) {
  const std::vector<std::string> path = cpp_path(type_name);
  if (cpp_namespace(type_name) == scope) return path.back();
  return fmt::format("::{}", fmt::join(path, "::"));
}

std::vector<std::string> cpp_members(const types::Object& object) {
  std::set<std::string> taken{cpp_path(object.name).back()};
  if (object.base) {
    const auto& base = object.base->get<types::Object>();
    taken.insert(cpp_path(base.name).back());
    for (const types::Object* above = &base; above != nullptr;
         above = above->base ? above->base->get_if<types::Object>() : nullptr)
      for (std::string& name : cpp_members(*above)) taken.insert(std::move(name));
  }
  for (const Member& member : object.own_members) find_named(member.type, taken);
  std::vector<std::string> names;
  for (const Member& member : object.own_members)
    names.push_back(unlike(cpp_identifier(member.name), taken));
  return names;
}

std::vector<std::string> cpp_enumerators(const types::IntEnum& named) {
  std::set<std::string> taken;
  std::vector<std::string> names;
  for (const EnumValue& value : named.values)
    names.push_back(unlike(cpp_identifier(value.name), taken));
  return names;
}

}  // namespace engram::idf
