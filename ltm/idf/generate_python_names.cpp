// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/generate_python_names.h"

#include <algorithm>
#include <filesystem>
#include <unordered_set>

namespace engram::idf {

namespace {

using Words = std::unordered_set<std::string>;

const Words& keywords() {
  static const Words kWords{
      "False", "None",     "True",  "and",    "as",   "assert", "async",  "await",    "break",
      "class", "continue", "def",   "del",    "elif", "else",   "except", "finally",  "for",
      "from",  "global",   "if",    "import", "in",   "is",     "lambda", "nonlocal", "not",
      "or",    "pass",     "raise", "return", "try",  "while",  "with",   "yield"};
  return kWords;
}

/// Names that generated code uses inside or around a class.
const Words& generated_words() {
  static const Words kWords{"to_idf",    "from_idf",    "idf_type",     "_idf_attributes",
                            "self",      "cls",         "list",         "dict",
                            "tuple",     "int",         "float",        "str",
                            "bool",      "range",       "np",           "NDArray",
                            "field",     "idf",         "enum",         "cache",
                            "dataclass", "annotations", "staticmethod", "property"};
  return kWords;
}

/// Names that every enum of Python, and every int, already has.
const Words& enum_words() {
  static const Words kWords{"name",
                            "value",
                            "mro",
                            "real",
                            "imag",
                            "numerator",
                            "denominator",
                            "conjugate",
                            "bit_length",
                            "bit_count",
                            "as_integer_ratio",
                            "to_bytes",
                            "from_bytes"};
  return kWords;
}

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_word(const std::string& name) {
  return keywords().contains(name) || generated_words().contains(name);
}

/// Names that Python changes (`__x`) or gives a meaning (`__x__`, in enums `_x_`).
bool is_special(std::string_view name) {
  if (name.ends_with("___")) return false;
  return name.starts_with("__") || (name.starts_with('_') && name.ends_with('_'));
}

/// `key` with as many `_` appended as needed.
template <typename IsTaken>
std::string free_name(std::string key, const IsTaken& is_taken) {
  while (is_word(key) || is_special(key) || is_taken(key)) key += '_';
  return key;
}

/// Collects the names of all types that `type` uses, without those inside its objects.
void add_used_classes(const Type& type, Words& used) {
  if (!type.name().empty()) {
    used.insert(python_class_name(type.name()));
    return;
  }
  for (const Member& part : type.parts()) add_used_classes(part.type, used);
}

Status check_key(std::string_view key, std::string_view owner) {
  if (is_python_identifier(key)) return {};
  return invalid_argument("'{}': the key '{}' is no identifier, which code needs", owner, key);
}

/// Names for `keys` that differ from each other and from `taken`.
Result<PythonNames> free_names(const std::vector<std::string>& keys, std::string_view owner,
                               Words taken, PythonNames names) {
  Words known(keys.begin(), keys.end());
  for (const std::string& key : keys) {
    ENGRAM_RETURN_IF_ERROR(check_key(key, owner));
    const std::string name = free_name(key, [&](const std::string& candidate) {
      return taken.contains(candidate) || (candidate != key && known.contains(candidate));
    });
    taken.insert(name);
    names.emplace(key, name);
  }
  return names;
}

}  // namespace

bool is_python_identifier(std::string_view name) {
  return !name.empty() && is_letter(name[0]) &&
         std::ranges::all_of(name, [](char c) { return is_letter(c) || is_digit(c); });
}

std::string python_class_name(std::string_view type_name) {
  const size_t end = type_name.rfind("::");
  const std::string_view last =
      end == std::string_view::npos ? type_name : type_name.substr(end + 2);
  return free_name(std::string(last), [](const std::string&) { return false; });
}

Result<std::string> python_module_name(std::string_view xml_name) {
  std::string module;
  const auto path = std::filesystem::path(xml_name).lexically_normal();
  for (const auto& part : path.parent_path() / path.stem()) {
    std::string name = part.string();
    if (name == ".." || part.is_absolute())
      return invalid_argument(
          "include '{}': needs a path inside an include path, as its module is "
          "imported from there",
          xml_name);
    for (char& c : name)
      if (!is_letter(c) && !is_digit(c)) c = '_';
    if (name.empty() || is_digit(name[0])) name.insert(0, "_");
    if (keywords().contains(name)) name += '_';
    module += (module.empty() ? "" : ".") + name;
  }
  return module;
}

Result<PythonNames> python_attributes(const types::Object& object) {
  PythonNames names;
  Words taken;
  if (object.base) {
    ENGRAM_ASSIGN_OR_RETURN(names, python_attributes(object.base->get<types::Object>()));
    for (const auto& [key, name] : names) taken.insert(name);
  }
  std::vector<std::string> keys;
  for (const Member& member : object.own_members) {
    keys.push_back(member.name);
    add_used_classes(member.type, taken);
  }
  return free_names(keys, object.name, std::move(taken), std::move(names));
}

Result<PythonNames> python_enum_names(const types::IntEnum& type) {
  std::vector<std::string> keys;
  for (const EnumValue& value : type.values) keys.push_back(value.name);
  return free_names(keys, type.name, enum_words(), {});
}

}  // namespace engram::idf
