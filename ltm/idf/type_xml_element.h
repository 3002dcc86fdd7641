// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <initializer_list>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/idf/type.h"

namespace engram::idf {

/// An XML text and its name, which locates errors in it.
///
/// Owns: nothing; the text must outlive it.
class XmlText {
 public:
  XmlText(std::string_view text, std::string name);

  [[nodiscard]] std::string_view text() const { return text_; }
  [[nodiscard]] const std::string& name() const { return name_; }

  /// "types.xml:12".
  [[nodiscard]] std::string place(ptrdiff_t offset) const;
  [[nodiscard]] std::string place(const pugi::xml_node& node) const {
    return place(node.offset_debug());
  }
  /// An error of kInvalidArgument at `node`.
  [[nodiscard]] Status error(const pugi::xml_node& node, std::string_view message) const;

 private:
  std::string_view text_;
  std::string name_;
  std::vector<size_t> line_ends_;
};

/// The attributes of one element, by lower-case name.
class XmlAttributes {
 public:
  /// Attributes that only C++ code of other generators needs are noted and ignored.
  /// Errors: kInvalidArgument for any other attribute that is not `allowed`.
  static Result<XmlAttributes> read(const XmlText& source, const pugi::xml_node& node,
                                    std::initializer_list<std::string_view> allowed,
                                    std::vector<std::string>& notes);

  /// Nothing where it is absent.
  [[nodiscard]] std::optional<std::string_view> find(std::string_view name) const;
  /// Errors: kInvalidArgument where it is absent.
  Result<std::string_view> get(std::string_view name) const;
  /// kFreeSize where it is absent, "-1", "*" or "dynamic".
  Result<int64_t> size(std::string_view name) const;
  Result<bool> flag(std::string_view name) const;
  Result<ElementType> element_type() const;
  /// unit, min, max.
  Result<Quantity> quantity() const;

 private:
  XmlAttributes(const XmlText& source, const pugi::xml_node& node)
      : source_(&source), node_(node) {}
  Result<std::optional<double>> bound(std::string_view name, std::string_view long_name) const;

  const XmlText* source_;
  pugi::xml_node node_;
  std::vector<std::pair<std::string, std::string_view>> values_;
};

/// Finds the type of an element `name` inside the namespace `scope`; nothing where there is none of
/// this name.
/// Errors: those of reading that type.
using FindType =
    std::function<Result<std::optional<Type>>(std::string_view name, std::string_view scope)>;

/// Reads `<Object>` and `<IntEnum>` definitions and the types inside them.
class XmlTypeReader {
 public:
  XmlTypeReader(const XmlText& source, FindType find_type, std::vector<std::string>& notes)
      : source_(source), find_type_(std::move(find_type)), notes_(notes) {}

  /// Reads the type that a child of `<GenerateTypes>` defines.
  Result<Type> read_definition(const pugi::xml_node& node);

 private:
  Result<Type> read_object(const pugi::xml_node& node);
  Result<Type> read_enum(const pugi::xml_node& node);
  Result<Member> read_member(const pugi::xml_node& node, std::string_view scope);
  Result<Type> read_type(const pugi::xml_node& node, std::string_view scope, int depth);
  Result<TypeValue> read_scalar(const pugi::xml_node& node, TypeKind kind);
  Result<TypeValue> read_array(const pugi::xml_node& node, TypeKind kind);
  Result<TypeValue> read_position(const pugi::xml_node& node);
  Result<TypeValue> read_image(const pugi::xml_node& node);
  Result<TypeValue> read_cloud(const pugi::xml_node& node);
  Result<TypeValue> read_matrix(const pugi::xml_node& node);
  Result<TypeValue> read_ndarray(const pugi::xml_node& node);
  Result<TypeValue> read_container(const pugi::xml_node& node, TypeKind kind,
                                   std::string_view scope, int depth);
  Result<Type> read_reference(const pugi::xml_node& node, std::string_view scope);
  Result<Type> finish(const pugi::xml_node& node, Result<TypeValue> value);

  /// Reads the type elements inside `node`; anything else there is an error.
  Result<std::vector<Type>> read_parts(const pugi::xml_node& node, size_t min, size_t max,
                                       std::string_view scope, int depth);
  Status check_empty(const pugi::xml_node& node) const;
  Result<XmlAttributes> read_attributes(const pugi::xml_node& node,
                                        std::initializer_list<std::string_view> allowed);

  const XmlText& source_;
  FindType find_type_;
  std::vector<std::string>& notes_;
};

/// Names of built-in kinds, which no other type may have: "int", "matrix", ... in any case.
[[nodiscard]] bool is_type_element(std::string_view name);

/// "kitchen::Cup": identifiers joined by "::".
[[nodiscard]] bool is_type_name(std::string_view name);

/// The documentation of `node`: its doc attribute, otherwise the comments directly before it.
[[nodiscard]] std::string read_doc(const pugi::xml_node& node);

}  // namespace engram::idf
