// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "ltm/idf/generate_cpp_names.h"
#include "ltm/idf/generate_cpp_type.h"

namespace engram::idf {

namespace {

CodeExpression leaf(std::string text) {
  return {.open = std::move(text)};
}

CodeExpression call(std::string_view function, std::vector<CodeExpression> arguments) {
  return {
      .open = fmt::format("idf::Type::{}(", function), .parts = std::move(arguments), .close = ")"};
}

CodeExpression braces(std::vector<CodeExpression> parts) {
  return {.open = "{", .parts = std::move(parts), .close = "}"};
}

CodeExpression element_of(ElementType element) {
  // In the order of ElementType, which counts from 1.
  static constexpr std::string_view kNames[] = {"kInt8",    "kInt16",  "kInt32",  "kInt64",
                                                "kUInt8",   "kUInt16", "kUInt32", "kUInt64",
                                                "kFloat32", "kFloat64"};
  return leaf(fmt::format("idf::ElementType::{}", kNames[static_cast<size_t>(element) - 1]));
}

CodeExpression size_of(int64_t size) {
  return leaf(size == kFreeSize ? "idf::kFreeSize" : std::to_string(size));
}

/// Appends unit and bounds, if any.
std::vector<CodeExpression> with_quantity(std::vector<CodeExpression> arguments,
                                          const Quantity& quantity) {
  if (quantity == Quantity{}) return arguments;
  std::vector<CodeExpression> parts{leaf(".unit = " + cpp_literal(quantity.unit).flat())};
  if (quantity.minimum) parts.push_back(leaf(".minimum = " + cpp_number(*quantity.minimum)));
  if (quantity.maximum) parts.push_back(leaf(".maximum = " + cpp_number(*quantity.maximum)));
  arguments.push_back(braces(std::move(parts)));
  return arguments;
}

/// Appends documentation, if any.
CodeExpression with_doc(std::vector<CodeExpression> parts, std::string_view doc) {
  if (!doc.empty()) parts.push_back(cpp_literal(doc));
  return braces(std::move(parts));
}

/// "kitchen::idf_type(kitchen::Fill{})". It is qualified, because a struct's own idf_type would
/// hide it.
CodeExpression enum_type(const types::IntEnum& named, std::string_view scope) {
  const std::string space = cpp_namespace(named.name);
  return leaf(fmt::format("{}{}::idf_type({}{{}})", space.empty() ? "" : "::", space,
                          cpp_reference(named.name, scope)));
}

struct FactoryOf {
  std::string_view scope;

  CodeExpression operator()(const types::Int& t) const {
    return call("int32", with_quantity({}, t.quantity));
  }
  CodeExpression operator()(const types::Long& t) const {
    return call("int64", with_quantity({}, t.quantity));
  }
  CodeExpression operator()(const types::Float& t) const {
    return call("float32", with_quantity({}, t.quantity));
  }
  CodeExpression operator()(const types::Double& t) const {
    return call("float64", with_quantity({}, t.quantity));
  }
  CodeExpression operator()(const types::String&) const { return call("string", {}); }
  CodeExpression operator()(const types::Bool&) const { return call("boolean", {}); }
  CodeExpression operator()(const types::Time&) const { return call("time", {}); }
  CodeExpression operator()(const types::MemoryLink&) const { return call("memory_link", {}); }
  CodeExpression operator()(const types::NdArray& t) const {
    std::vector<CodeExpression> sizes;
    for (const int64_t size : t.shape) sizes.push_back(size_of(size));
    return call("ndarray",
                with_quantity({element_of(t.element), braces(std::move(sizes))}, t.quantity));
  }
  CodeExpression operator()(const types::Matrix& t) const {
    return call("matrix", with_quantity({size_of(t.rows), size_of(t.cols), element_of(t.element)},
                                        t.quantity));
  }
  CodeExpression operator()(const types::Quaternion& t) const {
    return call("quaternion", {element_of(t.element)});
  }
  CodeExpression operator()(const types::Orientation& t) const {
    return call("orientation", {element_of(t.element)});
  }
  CodeExpression operator()(const types::Pose& t) const {
    return call("pose", {element_of(t.element)});
  }
  CodeExpression operator()(const types::Image& t) const {
    static constexpr std::string_view kNames[] = {"kRgb24", "kMono8", "kDepth32", "kDepth16"};
    std::vector<CodeExpression> arguments{
        leaf(fmt::format("idf::PixelType::{}", kNames[static_cast<size_t>(t.pixel)]))};
    if (t.height != kFreeSize || t.width != kFreeSize) {
      arguments.push_back(size_of(t.height));
      arguments.push_back(size_of(t.width));
    }
    return call("image", std::move(arguments));
  }
  CodeExpression operator()(const types::PointCloud& t) const {
    static constexpr std::string_view kNames[] = {
        "kXyz", "kXyzi", "kXyzl", "kXyzRgb", "kXyzRgba", "kXyzRgbl", "kXyzNormal", "kXyzRgbNormal"};
    std::vector<CodeExpression> arguments{
        leaf(fmt::format("idf::PointType::{}", kNames[static_cast<size_t>(t.point)]))};
    if (t.count != kFreeSize) arguments.push_back(size_of(t.count));
    return call("point_cloud", std::move(arguments));
  }
  CodeExpression operator()(const types::List& t) const {
    std::vector<CodeExpression> arguments{cpp_factory(t.element, scope)};
    if (t.size != kFreeSize) arguments.push_back(size_of(t.size));
    return call("list", std::move(arguments));
  }
  CodeExpression operator()(const types::Dict& t) const {
    return call("dict", {cpp_factory(t.element, scope)});
  }
  CodeExpression operator()(const types::Pair& t) const {
    return call("pair", {cpp_factory(t.first, scope), cpp_factory(t.second, scope)});
  }
  CodeExpression operator()(const types::Tuple& t) const {
    std::vector<CodeExpression> elements;
    for (const Type& element : t.elements) elements.push_back(cpp_factory(element, scope));
    return call("tuple", {braces(std::move(elements))});
  }
  CodeExpression operator()(const types::IntEnum& t) const {
    std::vector<CodeExpression> values;
    for (const EnumValue& value : t.values)
      values.push_back(
          with_doc({cpp_literal(value.name), leaf(cpp_number(int64_t{value.value}))}, value.doc));
    return call("int_enum", {cpp_literal(t.name), braces(std::move(values))});
  }
  CodeExpression operator()(const types::Object& t) const {
    std::vector<CodeExpression> members;
    for (const Member& member : t.own_members)
      members.push_back(
          with_doc({cpp_literal(member.name), cpp_factory(member.type, scope)}, member.doc));
    std::vector<CodeExpression> arguments{cpp_literal(t.name), braces(std::move(members))};
    if (t.base) arguments.push_back(cpp_factory(*t.base, scope));
    return call("object", std::move(arguments));
  }
};

CodeExpression documented(CodeExpression made, const Type& type) {
  if (type.is_optional()) {
    made = made.parts.empty() ? leaf(made.flat() + ".optional()")
                              : CodeExpression{made.open, made.parts, made.close + ".optional()"};
  }
  if (type.doc().empty()) return made;
  return {.open = ".with_doc(",
          .parts = {cpp_literal(type.doc())},
          .close = ")",
          .prefix = {std::move(made)}};
}

}  // namespace

CodeExpression cpp_factory(const Type& type, std::string_view scope) {
  const std::string optional = type.is_optional() ? ".optional()" : "";
  if (const auto* named = type.get_if<types::IntEnum>())
    return leaf(enum_type(*named, scope).open + optional);
  if (const auto* object = type.get_if<types::Object>())
    return leaf(cpp_reference(object->name, scope) + "::idf_type()" + optional);
  return documented(std::visit(FactoryOf{scope}, type.value()), type);
}

CodeExpression cpp_definition(const Type& type, std::string_view scope) {
  return documented(std::visit(FactoryOf{scope}, type.value()), type);
}

}  // namespace engram::idf
