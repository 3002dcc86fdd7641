// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/generate_python.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <unordered_map>
#include <unordered_set>

#include "ltm/idf/generate_python_default.h"
#include "ltm/idf/generate_python_member.h"
#include "ltm/idf/generate_python_names.h"
#include "ltm/idf/generate_python_type.h"

namespace engram::idf {

namespace {

constexpr size_t kIndent = 4;

/// The definitions of a file, each after those that it needs: Python evaluates bases and
/// defaults when it defines a class.
class Sorter {
 public:
  explicit Sorter(const TypeFile& file) : file_(file) {}

  std::vector<Type> sort() {
    for (const Type& type : file_.types) add(type);
    return std::move(sorted_);
  }

 private:
  void add(const Type& definition) {
    if (!seen_.insert(std::string(definition.name())).second) return;
    if (const auto* object = definition.get_if<types::Object>()) {
      if (object->base) add_used(*object->base);
      for (const Member& member : object->own_members) add_used(member.type);
    }
    sorted_.push_back(definition);
  }

  /// Ends, because types do not contain themselves.
  void add_used(const Type& type) {
    if (type.name().empty()) {
      for (const Member& part : type.parts()) add_used(part.type);
      return;
    }
    const auto own = std::ranges::find(file_.types, type.name(), &Type::name);
    if (own != file_.types.end()) add(*own);
  }

  const TypeFile& file_;
  std::unordered_set<std::string> seen_;
  std::vector<Type> sorted_;
};

/// Writes one module.
class ModuleWriter {
 public:
  explicit ModuleWriter(const TypeFile& file) : file_(file) {}

  Result<GeneratedFile> write() {
    const std::string xml = std::filesystem::path(file_.name).filename().string();
    ENGRAM_ASSIGN_OR_RETURN(const std::string module, python_module_name(xml));
    ENGRAM_RETURN_IF_ERROR(name_classes());
    ENGRAM_ASSIGN_OR_RETURN(const std::string own_imports, included_imports());
    std::string classes;
    for (const Type& type : Sorter(file_).sort()) {
      const bool is_enum = type.kind() == TypeKind::kIntEnum;
      auto made = is_enum ? enum_class(type) : object_class(type);
      if (!made.ok()) return made.status();
      classes += "\n\n" + *made;
    }
    return GeneratedFile{module + ".py",
                         head(xml) + imports(classes) + own_imports + all_names() + classes};
  }

 private:
  /// Checks that every class that the module defines or imports has a unique name.
  Status name_classes() {
    for (const auto* list : {&file_.types, &file_.included_types}) {
      for (const Type& type : *list) {
        if (type.name().empty())
          return invalid_argument("{}: a type without a name cannot become a class", file_.name);
        const auto [known, is_new] = classes_.emplace(python_class_name(type.name()), type.name());
        if (!is_python_identifier(known->first))
          return invalid_argument(
              "{}: the type '{}' cannot become a class, needs an identifier "
              "as the last part of its name",
              file_.name, type.name());
        if (!is_new)
          return invalid_argument(
              "{}: the types '{}' and '{}' both become the Python class '{}', "
              "needs names with different ends",
              file_.name, known->second, type.name(), known->first);
      }
    }
    return {};
  }

  static std::string head(std::string_view xml) {
    std::string shown(xml);
    for (char& c : shown)
      if (static_cast<unsigned char>(c) < 0x20) c = ' ';
    return fmt::format("# Generated from {} by engram idf generate: change that file, not this.\n",
                       shown) +
           python_docstring(fmt::format("The types of {}.", shown), 0) + "\n";
  }

  /// The imports that the text of the classes needs, in groups: standard library, other libraries,
  /// engram.
  static std::string imports(std::string_view classes) {
    std::string text = "from __future__ import annotations\n";
    const auto uses = [classes](std::string_view what) {
      return classes.find(what) != std::string_view::npos;
    };
    if (classes.empty()) return text;
    text += '\n';
    if (uses("(enum.IntEnum):")) text += "import enum\n";
    if (uses("@dataclass"))
      text += uses("= field(") ? "from dataclasses import dataclass, field\n"
                               : "from dataclasses import dataclass\n";
    text += "from functools import cache\n\n";
    if (uses("np.")) text += "import numpy as np\n";
    if (uses("NDArray[")) text += "from numpy.typing import NDArray\n";
    return text + (uses("np.") ? "\n" : "") + "from engram import idf\n";
  }

  /// Imports each type from the first include that has it.
  Result<std::string> included_imports() const {
    std::string text;
    std::unordered_set<std::string> imported;
    for (const TypeInclude& include : file_.includes) {
      ENGRAM_ASSIGN_OR_RETURN(const std::string module, python_module_name(include.name));
      std::set<std::string> names;
      for (const std::string& name : include.type_names)
        if (imported.insert(name).second) names.insert(python_class_name(name));
      std::vector<PythonExpression> parts;
      for (const std::string& name : names) parts.push_back({name});
      if (parts.empty()) continue;
      text += from_import(module, std::move(parts));
    }
    return text;
  }

  static std::string from_import(const std::string& module, std::vector<PythonExpression> names) {
    std::string line = fmt::format("from {} import ", module);
    std::string joined;
    for (const PythonExpression& name : names) joined += (joined.empty() ? "" : ", ") + name.head;
    if (line.size() + joined.size() <= kPythonLine) return line + joined + "\n";
    return to_string(python_call(line + "(", std::move(names)), 0, kPythonLine) + "\n";
  }

  [[nodiscard]] std::string all_names() const {
    std::set<std::string> sorted;
    for (const auto& [name, type_name] : classes_) sorted.insert(python_string(name));
    if (sorted.empty()) return "";
    std::vector<PythonExpression> names;
    for (const std::string& name : sorted) names.push_back({name});
    return "\n" + to_string(python_call("__all__ = [", std::move(names)), 0, 0) + "\n";
  }

  static std::string class_doc(const Type& type) {
    return python_docstring(type.doc().empty() ? fmt::format("{}.", type.name()) : type.doc(),
                            kIndent);
  }

  Result<std::string> type_method(const Type& type) const {
    ENGRAM_ASSIGN_OR_RETURN(const PythonExpression made, python_type(type, file_));
    return fmt::format(
        "\n    @staticmethod\n    @cache\n    def idf_type() -> idf.types.{}:\n"
        "        return {}\n",
        to_string(type.kind()), to_string(made, 2 * kIndent, 2 * kIndent + 7));
  }

  Result<std::string> enum_class(const Type& type) const {
    const auto& values = type.get<types::IntEnum>();
    ENGRAM_ASSIGN_OR_RETURN(const PythonNames names, python_enum_names(values));
    std::string text = fmt::format("class {}(enum.IntEnum):\n{}\n", python_class_name(values.name),
                                   class_doc(type));
    for (const EnumValue& value : values.values) {
      text += fmt::format("    {} = {}\n", names.at(value.name), value.value);
      if (!value.doc.empty()) text += python_docstring(value.doc, kIndent);
    }
    ENGRAM_ASSIGN_OR_RETURN(const std::string method, type_method(type));
    return text + method;
  }

  Result<std::string> object_class(const Type& type) const {
    const auto& object = type.get<types::Object>();
    ENGRAM_ASSIGN_OR_RETURN(const PythonNames names, python_attributes(object));
    const std::string base =
        object.base ? python_class_name(object.base->name()) : "idf.TypedObject";
    std::string text = fmt::format("@dataclass(kw_only=True, eq=False)\nclass {}({}):\n{}",
                                   python_class_name(object.name), base, class_doc(type));
    text += renamed(object, base, names);
    if (!object.own_members.empty()) text += '\n';
    for (const Member& member : object.own_members) text += attribute(member, names);
    ENGRAM_ASSIGN_OR_RETURN(const std::string method, type_method(type));
    return text + method;
  }

  static std::string attribute(const Member& member, const PythonNames& names) {
    const std::string begin =
        fmt::format("    {}: {} = ", names.at(member.name), python_hint(member.type));
    const std::string doc = python_member_doc(member);
    return begin + to_string(python_default(member.type), kIndent, begin.size()) + "\n" +
           (doc.empty() ? "" : python_docstring(doc, kIndent));
  }

  /// The attributes whose names differ from their keys.
  static std::string renamed(const types::Object& object, std::string_view base,
                             const PythonNames& names) {
    std::vector<PythonExpression> parts;
    for (const Member& member : object.own_members) {
      const std::string& name = names.at(member.name);
      if (name != member.name)
        parts.push_back({fmt::format("{}: {}", python_string(member.name), python_string(name))});
    }
    if (parts.empty()) return "";
    if (object.base) parts.insert(parts.begin(), {fmt::format("**{}._idf_attributes", base)});
    return "\n    _idf_attributes = " +
           to_string(python_call("{", std::move(parts)), kIndent, kIndent + 18) + "\n";
  }

  const TypeFile& file_;
  /// The names of types by those of their classes.
  std::unordered_map<std::string, std::string> classes_;
};

}  // namespace

Result<std::vector<GeneratedFile>> generate_python(const TypeFile& file) {
  ENGRAM_ASSIGN_OR_RETURN(GeneratedFile made, ModuleWriter(file).write());
  return std::vector<GeneratedFile>{std::move(made)};
}

}  // namespace engram::idf
