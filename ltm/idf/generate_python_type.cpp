// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/generate_python_type.h"

#include <fmt/format.h>

#include "ltm/idf/generate_python_names.h"

namespace engram::idf {

namespace {

using Parts = std::vector<PythonExpression>;

PythonExpression text_part(std::string_view key, std::string_view value) {
  return {fmt::format("{}={}", key, python_string(value))};
}

PythonExpression number_part(std::string_view key, int64_t value) {
  return {fmt::format("{}={}", key, value)};
}

void add_size(std::string_view key, int64_t size, Parts& parts) {
  if (size != kFreeSize) parts.push_back(number_part(key, size));
}

void add_element(ElementType element, Parts& parts) {
  if (element != ElementType::kFloat32) parts.push_back(text_part("element", to_string(element)));
}

void add_bound(std::string_view key, std::optional<double> bound, Parts& parts) {
  if (!bound) return;
  std::string text = fmt::format("{}={}", key, *bound);
  // Python would read an int without the point.
  if (text.find_first_of(".e", key.size()) == std::string::npos) text += ".0";
  parts.push_back({std::move(text)});
}

void add_quantity(const Quantity& quantity, Parts& parts) {
  if (!quantity.unit.empty()) parts.push_back(text_part("unit", quantity.unit));
  add_bound("minimum", quantity.minimum, parts);
  add_bound("maximum", quantity.maximum, parts);
}

PythonExpression prefixed(std::string_view key, PythonExpression expression) {
  expression.head.insert(0, fmt::format("{}=", key));
  return expression;
}

/// Adds one keyword argument for each field of an alternative of TypeValue.
class Describer {
 public:
  Describer(const TypeFile& file, Parts& parts) : file_(file), parts_(parts) {}

  Status operator()(const types::NdArray& type) {
    add_element(type.element, parts_);
    Parts sizes;
    for (const int64_t size : type.shape) sizes.push_back({std::to_string(size)});
    parts_.push_back(python_call("shape=(", std::move(sizes)));
    add_quantity(type.quantity, parts_);
    return {};
  }
  Status operator()(const types::Matrix& type) {
    add_element(type.element, parts_);
    add_size("rows", type.rows, parts_);
    add_size("cols", type.cols, parts_);
    add_quantity(type.quantity, parts_);
    return {};
  }
  Status operator()(const types::Image& type) {
    parts_.push_back(text_part("pixel", to_string(type.pixel)));
    add_size("height", type.height, parts_);
    add_size("width", type.width, parts_);
    return {};
  }
  Status operator()(const types::PointCloud& type) {
    parts_.push_back(text_part("point", to_string(type.point)));
    add_size("count", type.count, parts_);
    return {};
  }
  Status operator()(const types::IntEnum& type) {
    Parts values;
    for (const EnumValue& value : type.values) {
      Parts entry{{python_string(value.name)}, {std::to_string(value.value)}};
      if (!value.doc.empty()) entry.push_back({python_string(value.doc)});
      values.push_back(python_call("idf.types.EnumValue(", std::move(entry)));
    }
    parts_.push_back(text_part("name", type.name));
    parts_.push_back(python_call("values=(", std::move(values)));
    return {};
  }
  Status operator()(const types::List& type) {
    ENGRAM_RETURN_IF_ERROR(add_type("element", type.element));
    add_size("size", type.size, parts_);
    return {};
  }
  Status operator()(const types::Dict& type) { return add_type("element", type.element); }
  Status operator()(const types::Pair& type) {
    ENGRAM_RETURN_IF_ERROR(add_type("first", type.first));
    return add_type("second", type.second);
  }
  Status operator()(const types::Tuple& type) {
    Parts elements;
    for (const Type& element : type.elements) {
      ENGRAM_ASSIGN_OR_RETURN(auto made, use(element));
      elements.push_back(std::move(made));
    }
    parts_.push_back(python_call("elements=(", std::move(elements)));
    return {};
  }
  Status operator()(const types::Object& type) {
    parts_.push_back(text_part("name", type.name));
    if (type.base) ENGRAM_RETURN_IF_ERROR(add_type("base", *type.base));
    Parts members;
    for (const Member& member : type.own_members) {
      ENGRAM_ASSIGN_OR_RETURN(auto made, use(member.type));
      Parts entry{{python_string(member.name)}, std::move(made)};
      if (!member.doc.empty()) entry.push_back({python_string(member.doc)});
      members.push_back(python_call("idf.types.Member(", std::move(entry)));
    }
    parts_.push_back(python_call("members=(", std::move(members)));
    return {};
  }
  /// The kinds that have an element type, a quantity or nothing.
  template <typename T>
  Status operator()(const T& type) {
    if constexpr (requires { type.element; }) add_element(type.element, parts_);
    if constexpr (requires { type.quantity; }) add_quantity(type.quantity, parts_);
    return {};
  }

  /// The expression of a type that is used. A named type is taken from its class, so that it is
  /// defined once.
  Result<PythonExpression> use(const Type& type) {
    if (!type.name().empty() || type.kind() == TypeKind::kObject) return refer(type);
    Parts parts;
    ENGRAM_RETURN_IF_ERROR(std::visit(Describer(file_, parts), type.value()));
    if (type.is_optional()) parts.push_back({"optional=True"});
    if (!type.doc().empty()) parts.push_back(text_part("doc", type.doc()));
    return python_call(fmt::format("idf.types.{}(", to_string(type.kind())), std::move(parts));
  }

 private:
  Status add_type(std::string_view key, const Type& type) {
    ENGRAM_ASSIGN_OR_RETURN(auto made, use(type));
    parts_.push_back(prefixed(key, std::move(made)));
    return {};
  }

  Result<PythonExpression> refer(const Type& type) const {
    const Type* definition = file_.find(type.name());
    // The class of another type with this name would replace this one in silence.
    if (definition == nullptr || definition->value() != type.value())
      return invalid_argument("{}: uses the type '{}', which neither it nor an include defines so",
                              file_.name, type.name());
    std::string text = python_class_name(type.name()) + ".idf_type()";
    if (type.is_optional()) text += ".with_optional()";
    if (type.doc() != definition->doc())
      text += fmt::format(".with_doc({})", python_string(type.doc()));
    return PythonExpression{std::move(text)};
  }

  const TypeFile& file_;
  Parts& parts_;
};

}  // namespace

Result<PythonExpression> python_type(const Type& definition, const TypeFile& file) {
  Parts parts;
  ENGRAM_RETURN_IF_ERROR(std::visit(Describer(file, parts), definition.value()));
  if (!definition.doc().empty()) parts.push_back(text_part("doc", definition.doc()));
  parts.push_back({"python=" + python_class_name(definition.name())});
  return python_call(fmt::format("idf.types.{}(", to_string(definition.kind())), std::move(parts));
}

}  // namespace engram::idf
