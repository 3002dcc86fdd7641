// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/cast.h"
#include "ltm/idf/element_visit.h"
#include "ltm/idf/quantity.h"

namespace engram::idf {

namespace {

/// Type::create made sure that there is a number within the bounds.
template <typename T>
T number_of(const Quantity& quantity) {
  return closest_to_zero<T>(quantity).value_or(T{});
}

Data array_of(const ArrayType& array, const Quantity& quantity) {
  Shape shape = array.shape;
  size_t count = 1;
  for (int64_t& size : shape) {
    if (size == kFreeSize) size = 0;
    count *= static_cast<size_t>(size);
  }
  return visit_element_type(array.element, [&]<typename T>(T) {
    return Data(NdArray::take<T>(std::move(shape), std::vector<T>(count, number_of<T>(quantity))));
  });
}

Data identity(ElementType element) {
  return visit_element_type(element, []<typename T>(T) {
    return Data(NdArray::take<T>({4}, {T{1}, T{0}, T{0}, T{0}}));
  });
}

struct Defaults {
  const Type& type;

  Data operator()(const types::Int& t) const { return number_of<int32_t>(t.quantity); }
  Data operator()(const types::Long& t) const { return number_of<int64_t>(t.quantity); }
  Data operator()(const types::Float& t) const { return number_of<float>(t.quantity); }
  Data operator()(const types::Double& t) const { return number_of<double>(t.quantity); }
  Data operator()(const types::String&) const { return ""; }
  Data operator()(const types::Bool&) const { return false; }
  Data operator()(const types::Time&) const { return int64_t{0}; }
  Data operator()(const types::MemoryLink&) const { return ""; }
  Data operator()(const types::IntEnum& t) const { return t.values.front().value; }
  Data operator()(const types::Quaternion& t) const { return identity(t.element); }
  Data operator()(const types::Orientation& t) const { return identity(t.element); }
  Data operator()(const types::Dict&) const { return Dict(); }
  Data operator()(const types::Object&) const { return members(); }
  Data operator()(const types::Pose&) const { return members(); }
  Data operator()(const types::List& t) const {
    if (t.size <= 0) return List();
    return List(static_cast<size_t>(t.size), default_value(t.element));
  }
  /// For tuples, pairs and everything that is an array.
  template <typename T>
  Data operator()(const T&) const {
    if (const auto array = type.as_array())
      return array_of(*array, type.quantity() == nullptr ? Quantity{} : *type.quantity());
    List list;
    for (const Member& part : type.parts()) list.push_back(default_value(part.type));
    return list;
  }

 private:
  Data members() const {
    Dict dict;
    const std::vector<Member> parts = type.parts();
    dict.reserve(parts.size());
    for (const Member& part : parts) dict.append_unique(part.name, default_value(part.type));
    return dict;
  }
};

}  // namespace

Data default_value(const Type& type) {
  if (type.is_optional()) return None{};
  return std::visit(Defaults{type}, type.value());
}

}  // namespace engram::idf
