// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/generate_python_default.h"

#include <fmt/format.h>

#include <algorithm>

#include "ltm/idf/cast.h"
#include "ltm/idf/element_visit.h"
#include "ltm/idf/generate_python_member.h"
#include "ltm/idf/generate_python_names.h"

namespace engram::idf {

namespace {

/// A number as a float literal of Python.
template <typename T>
std::string float_text(T value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string element_text(ElementType element) {
  return fmt::format("np.{}", to_string(element));
}

/// An expression for a new value, and whether all objects may share one.
struct Default {
  PythonExpression expression;
  bool is_shared = true;
};

Default default_of(const Type& type);

std::string number_text(const Data& value) {
  if (const auto* number = value.get_if<float>()) return float_text(*number);
  if (const auto* number = value.get_if<double>()) return float_text(*number);
  if (const auto* number = value.get_if<int32_t>()) return std::to_string(*number);
  return std::to_string(value.get<int64_t>());
}

/// The number that fills the default of the array; empty for zero.
std::string fill_text(const Type& type) {
  if (type.quantity() == nullptr || !type.quantity()->is_bounded()) return "";
  return visit_element_type(type.as_array()->element, [&]<typename T>(T) -> std::string {
    // An array of one element is enough: the actual shape may have no elements, or very many.
    const Type one = Type::ndarray(kElementTypeOf<T>, {1}, *type.quantity());
    const Data made = default_value(one);
    const T value = made.get<NdArray>().values<T>()[0];
    if (value == T{0}) return "";
    if constexpr (std::floating_point<T>)
      return float_text(value);
    else
      return std::to_string(value);
  });
}

PythonExpression array_default(const Type& type) {
  const ArrayType array = *type.as_array();
  const std::string element = element_text(array.element);
  if (type.kind() == TypeKind::kQuaternion || type.kind() == TypeKind::kOrientation)
    return {fmt::format("np.array([1, 0, 0, 0], {})", element)};
  std::string shape;
  for (const int64_t size : array.shape)
    shape += (shape.empty() ? "" : ", ") + std::to_string(std::max<int64_t>(size, 0));
  if (array.shape.size() != 1) shape = "(" + shape + ")";
  const std::string fill = fill_text(type);
  if (fill.empty()) return {fmt::format("np.zeros({}, {})", shape, element)};
  return {fmt::format("np.full({}, {}, {})", shape, fill, element)};
}

Default list_default(const types::List& list) {
  if (list.size <= 0) return {{"list[" + python_hint(list.element) + "]()"}, false};
  const Default element = default_of(list.element);
  const std::string text = to_string(element.expression, 0, 0);
  if (element.is_shared) return {{fmt::format("[{}] * {}", text, list.size)}, false};
  return {{fmt::format("[{} for _ in range({})]", text, list.size)}, false};
}

Default tuple_default(const Type& type) {
  Default made{python_call("(", {})};
  for (const Member& part : type.parts()) {
    Default element = default_of(part.type);
    made.is_shared = made.is_shared && element.is_shared;
    made.expression.parts.push_back(std::move(element.expression));
  }
  return made;
}

std::string enum_default(const types::IntEnum& type) {
  const auto names = python_enum_names(type);
  const std::string& key = type.values.front().name;
  return fmt::format("{}.{}", python_class_name(type.name), names.ok() ? names->at(key) : key);
}

Default default_of(const Type& type) {
  if (type.is_optional()) return {{"None"}};
  if (type.as_array()) return {array_default(type), false};
  switch (type.kind()) {
    case TypeKind::kBool:
      return {{"False"}};
    case TypeKind::kString:
    case TypeKind::kMemoryLink:
      return {{"\"\""}};
    case TypeKind::kIntEnum:
      return {{enum_default(type.get<types::IntEnum>())}};
    case TypeKind::kPose:
      if (type.get<types::Pose>().element == ElementType::kFloat32) return {{"idf.Pose()"}, false};
      return {{"idf.Pose.identity(np.float64)"}, false};
    case TypeKind::kList:
      return list_default(type.get<types::List>());
    case TypeKind::kDict:
      return {{python_hint(type) + "()"}, false};
    case TypeKind::kTuple:
    case TypeKind::kPair:
      return tuple_default(type);
    case TypeKind::kObject:
      return {{python_class_name(type.name()) + "()"}, false};
    default:
      return {{number_text(default_value(type))}};
  }
}

}  // namespace

PythonExpression python_default(const Type& type) {
  Default made = default_of(type);
  if (made.is_shared) return std::move(made.expression);
  // A class that is called without arguments is a factory itself. Its type arguments are dropped,
  // because the hint has them.
  std::string& head = made.expression.head;
  const bool is_factory = head.ends_with("()");
  if (is_factory) head.resize(std::min(head.find('['), head.size() - 2));
  head.insert(0, is_factory ? "default_factory=" : "default_factory=lambda: ");
  return python_call("field(", {std::move(made.expression)});
}

}  // namespace engram::idf
