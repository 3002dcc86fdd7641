// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/generate_cpp.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <set>

#include "ltm/idf/generate_cpp_names.h"
#include "ltm/idf/generate_cpp_type.h"
#include "ltm/idf/type_xml_element.h"

namespace engram::idf {

namespace {

namespace fs = std::filesystem;

/// "kitchen/Thing" for "kitchen/Thing.xml", as used in an #include.
Result<std::string> include_stem(const std::string& name) {
  for (const char c : name)
    if (c == '"' || c == '\\' || c == '<' || c == '>' || static_cast<unsigned char>(c) < 0x20)
      return invalid_argument(
          "file '{}': needs a name without quotes, brackets, backslashes and "
          "control characters, as code includes it",
          name);
  return fs::path(name).replace_extension().string();
}

/// Checks that code can be generated: the file knows named parts, and names are identifiers.
Status check_parts(const TypeFile& file, const Type& type) {
  if (const auto* object = type.get_if<types::Object>())
    for (const Member& member : object->own_members)
      if (!is_type_name(member.name) || member.name.find(':') != std::string::npos)
        return invalid_argument("type '{}': the member '{}' needs an identifier as its name",
                                object->name, member.name);
  for (const Member& part : type.parts()) {
    if (part.type.kind() != TypeKind::kObject && part.type.kind() != TypeKind::kIntEnum) {
      ENGRAM_RETURN_IF_ERROR(check_parts(file, part.type));
    } else if (file.find(part.type.name()) == nullptr) {
      return invalid_argument("type '{}': uses '{}', needs a type of this file or an included one",
                              type.name(), part.type.name());
    }
  }
  return {};
}

/// Checks that no two types, and no type and namespace, have the same name in C++.
Status check_names(const TypeFile& file) {
  std::map<std::string, std::string_view> names;
  std::map<std::string, std::string_view> spaces;
  std::vector<Type> types = file.types;
  types.insert(types.end(), file.included_types.begin(), file.included_types.end());
  for (const Type& type : types) {
    if (!is_type_name(type.name()))
      return invalid_argument("type '{}': needs identifiers joined by '::'", type.name());
    std::string path;
    for (const std::string& part : cpp_path(type.name())) {
      if (!path.empty()) spaces.emplace(path, type.name());
      path += (path.empty() ? "" : "::") + part;
    }
    const auto [known, is_new] = names.emplace(path, type.name());
    if (!is_new)
      return invalid_argument("types '{}' and '{}': both would be '{}' in C++", known->second,
                              type.name(), path);
  }
  for (const auto& [name, type] : names)
    if (const auto space = spaces.find(name); space != spaces.end())
      return invalid_argument("types '{}' and '{}': '{}' cannot be a type and a namespace in C++",
                              type, space->second, name);
  return {};
}

/// The types of a file, each after the types that it uses, as members need complete types.
class InOrderOfUse {
 public:
  explicit InOrderOfUse(const TypeFile& file) {
    for (const Type& type : file.types) own_.emplace(type.name(), &type);
    for (const Type& type : file.types) add(type);
  }
  [[nodiscard]] const std::vector<const Type*>& types() const { return order_; }

 private:
  void add(const Type& type) {
    if (!type.name().empty() && !done_.emplace(type.name()).second) return;
    if (const auto* object = type.get_if<types::Object>(); object != nullptr && object->base)
      add(*object->base);
    for (const Member& part : type.parts()) add(part.type);
    if (const auto own = own_.find(type.name()); own != own_.end()) order_.push_back(own->second);
  }

  std::map<std::string, const Type*, std::less<>> own_;
  std::set<std::string> done_;
  std::vector<const Type*> order_;
};

/// The declarations and definitions of one type.
struct Code {
  std::string header;
  std::string source;
};

Code enum_code(const Type& type) {
  const auto& named = type.get<types::IntEnum>();
  const std::string name = cpp_path(named.name).back();
  const std::vector<std::string> enumerators = cpp_enumerators(named);
  std::string values;
  std::string cases;
  for (size_t i = 0; i < named.values.size(); ++i) {
    const EnumValue& value = named.values[i];
    values += cpp_comment(value.doc, 2);
    values += fmt::format("  {} = {},\n", enumerators[i], cpp_number(int64_t{value.value}));
    cases += fmt::format("    case {}::{}:\n      return {};\n", name, enumerators[i],
                         cpp_literal(value.name).flat());
  }
  std::string definition = "  static const idf::Type kType = ";
  cpp_definition(type, cpp_namespace(named.name)).lay_out(definition, 2, 1);
  return {fmt::format(R"({0}enum class {1} : int32_t {{
{2}}};

/// The name that the type gives a value; empty where it has none.
[[nodiscard]] std::string_view to_string({1} value);

/// What a {1} is as a value.
[[nodiscard]] const engram::idf::Type& idf_type({1});
)",
                      cpp_comment(type.doc(), 0), name, values),
          fmt::format(R"(std::string_view to_string({0} value) {{
  switch (value) {{
{1}  }}
  return {{}};
}}

const engram::idf::Type& idf_type({0}) {{
  namespace idf = engram::idf;
{2};
  return kType;
}}
)",
                      name, cases, definition)};
}

/// The comment and declaration of one member.
std::string member_code(const Member& member, std::string_view identifier, std::string_view scope) {
  const std::string initial = cpp_initial(member.type, scope);
  std::string code = cpp_comment(member.doc, 2);
  // A named type has its documentation at its own declaration.
  if (member.type.name().empty()) code += cpp_comment(member.type.doc(), 2);
  code += cpp_comment(cpp_facts(member.type), 2);
  const std::string type = cpp_type(member.type, scope);
  if (initial == "{}")
    code += fmt::format("  {} {}{{}};\n", type, identifier);
  else if (initial.empty())
    code += fmt::format("  {} {};\n", type, identifier);
  else if (type.size() + identifier.size() + initial.size() + 7 <= kCodeColumns)
    code += fmt::format("  {} {} = {};\n", type, identifier, initial);
  else
    code += fmt::format("  {} {} =\n      {};\n", type, identifier, initial);
  return code;
}

Code object_code(const Type& type) {
  const auto& object = type.get<types::Object>();
  const std::string scope = cpp_namespace(object.name);
  const std::string name = cpp_path(object.name).back();
  const std::vector<std::string> identifiers = cpp_members(object);
  std::string members;
  std::string visits;
  std::string base;
  if (object.base) {
    base = cpp_reference(object.base->name(), scope);
    visits += fmt::format("    {}::for_each_member(visit);\n", base);
    base = " : " + base;
  }
  for (size_t i = 0; i < identifiers.size(); ++i) {
    const Member& member = object.own_members[i];
    members += member_code(member, identifiers[i], scope);
    visits += fmt::format("    visit({}, &{}::{});\n", cpp_literal(member.name).flat(), name,
                          identifiers[i]);
  }
  if (!members.empty()) members += '\n';
  std::string definition = "  static const idf::Type kType = ";
  cpp_definition(type, scope).lay_out(definition, 2, 1);
  return {fmt::format(R"({0}struct {1}{2} {{
{3}  /// What a {1} is as a value.
  [[nodiscard]] static const engram::idf::Type& idf_type();

  /// The object as a value; shares images, point clouds and arrays with it. Bounds, sizes and
  /// pixels are as they are here: idf::check tells where they are not as the type says.
  [[nodiscard]] engram::idf::Data to_idf() const;

  /// The object that a value describes; shares images, point clouds and arrays with it. Leaves out
  /// members of the value that are not here, widens numbers, does not look at bounds (idf::check
  /// does).
  /// Errors: kInvalidArgument listing by path what does not fit.
  [[nodiscard]] static engram::Result<{1}> from_idf(const engram::idf::Data& data);

  /// Calls visit(key, &{1}::member) for all members, in the order of the type.
  template <typename Visit>
  static void for_each_member({4}Visit&& visit) {{
{5}  }}

  /// Bit by bit: NaN equals the same NaN.
  friend bool operator==(const {1}& a, const {1}& b);
}};
)",
                      cpp_comment(type.doc(), 0), name, base, members,
                      visits.empty() ? "[[maybe_unused]] " : "", visits),
          fmt::format(R"(const engram::idf::Type& {0}::idf_type() {{
  namespace idf = engram::idf;
{1};
  return kType;
}}

engram::idf::Data {0}::to_idf() const {{
  return engram::typed::to_idf(*this);
}}

engram::Result<{0}> {0}::from_idf(const engram::idf::Data& data) {{
  return engram::typed::from_idf<{0}>(data);
}}

bool operator==(const {0}& a, const {0}& b) {{
  return engram::typed::equal(a, b);
}}
)",
                      name, definition)};
}

/// Writes the code of types inside their namespaces.
class NamespaceWriter {
 public:
  void add(std::string_view type_name, const std::string& code) {
    if (const std::string scope = cpp_namespace(type_name); scope != scope_) {
      close();
      if (!scope.empty()) text_ += fmt::format("\nnamespace {} {{\n", scope);
      scope_ = scope;
    }
    text_ += '\n' + code;
  }
  [[nodiscard]] std::string finish() {
    close();
    return std::move(text_);
  }

 private:
  void close() {
    if (!scope_.empty()) text_ += fmt::format("\n}}  // namespace {}\n", scope_);
    scope_.clear();
  }

  std::string text_;
  std::string scope_;
};

std::string includes(const std::set<std::string>& names, char open, char close) {
  std::string text = names.empty() ? "" : "\n";
  for (const std::string& name : names) text += fmt::format("#include {}{}{}\n", open, name, close);
  return text;
}

CppHeaders headers_of(const TypeFile& file) {
  CppHeaders headers;
  headers.own = {"ltm/idf/type.h"};
  headers.sources = {"ltm/typed/convert.h"};
  for (const Type& type : file.types) {
    if (type.kind() == TypeKind::kIntEnum) {
      headers.system.emplace("cstdint");
      headers.system.emplace("string_view");
    }
    const auto* object = type.get_if<types::Object>();
    if (object == nullptr) continue;
    headers.own.emplace("ltm/core/status.h");
    headers.own.emplace("ltm/idf/data.h");
    for (const Member& member : object->own_members) headers.add(member.type);
  }
  return headers;
}

/// Adds the conversions that members of included types need, whatever their parts are.
void add_included_sources(const TypeFile& file, CppHeaders& headers) {
  CppHeaders included;
  for (const Type& type : file.included_types)
    if (const auto* object = type.get_if<types::Object>())
      for (const Member& member : object->own_members) included.add(member.type);
  headers.sources.merge(included.sources);
}

}  // namespace

Result<std::vector<GeneratedFile>> generate_cpp(const TypeFile& file) {
  const std::string xml = fs::path(file.name).filename().string();
  ENGRAM_ASSIGN_OR_RETURN(const std::string stem, include_stem(xml));
  ENGRAM_RETURN_IF_ERROR(check_names(file));
  for (const Type& type : file.types) ENGRAM_RETURN_IF_ERROR(check_parts(file, type));
  CppHeaders headers = headers_of(file);
  add_included_sources(file, headers);
  std::set<std::string> siblings;
  for (const TypeInclude& include : file.includes) {
    ENGRAM_ASSIGN_OR_RETURN(const std::string included, include_stem(include.name));
    siblings.insert(included + ".h");
  }
  NamespaceWriter declarations;
  NamespaceWriter definitions;
  const InOrderOfUse in_order(file);
  for (const Type* type : in_order.types()) {
    const Code code = type->kind() == TypeKind::kIntEnum ? enum_code(*type) : object_code(*type);
    declarations.add(type->name(), code.header);
    definitions.add(type->name(), code.source);
  }
  const std::string title =
      fmt::format("// Generated from {} by `engram idf generate`; changes here get lost.\n", xml);
  return std::vector<GeneratedFile>{
      {stem + ".h", title + "#pragma once\n" + includes(headers.system, '<', '>') +
                        includes(headers.libraries, '<', '>') + includes(headers.own, '"', '"') +
                        includes(siblings, '"', '"') + declarations.finish()},
      {stem + ".cpp", title + fmt::format("#include \"{}.h\"\n", stem) +
                          includes(headers.sources, '"', '"') + definitions.finish()}};
}

}  // namespace engram::idf
