// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "ltm/idf/cast.h"
#include "ltm/idf/type.h"
#include "tests/ltm/random_values.h"

namespace engram {

/// Made-up IDF types of every kind, and values that are of them.
class RandomTypes {
 public:
  explicit RandomTypes(uint64_t seed) : values_(seed) {}

  RandomValues& values() { return values_; }

  idf::Type type(int depth) {
    idf::Type made = required(depth);
    if (chance(5)) made = made.optional();
    return chance(8) ? made.with_doc("doc " + values_.text()) : made;
  }

  /// A value that passes check.
  idf::Data value_of(const idf::Type& type) {
    if (type.is_optional() && chance(2)) return idf::None{};
    switch (type.kind()) {
      case idf::TypeKind::kString:
      case idf::TypeKind::kMemoryLink:
        return values_.text();
      case idf::TypeKind::kBool:
        return chance(2);
      case idf::TypeKind::kTime:
        return static_cast<int64_t>(values_.bits());
      case idf::TypeKind::kIntEnum: {
        const auto& known = type.get<idf::types::IntEnum>().values;
        return known[values_.below(known.size())].value;
      }
      case idf::TypeKind::kInt:
        return number<int32_t>(*type.quantity());
      case idf::TypeKind::kLong:
        return number<int64_t>(*type.quantity());
      case idf::TypeKind::kFloat:
        return number<float>(*type.quantity());
      case idf::TypeKind::kDouble:
        return number<double>(*type.quantity());
      case idf::TypeKind::kOrientation:
        return rotation(type.as_array()->element);
      case idf::TypeKind::kList:
        return list_of(type);
      case idf::TypeKind::kDict:
        return dict_of(type);
      case idf::TypeKind::kTuple:
      case idf::TypeKind::kPair: {
        idf::List made;
        for (const idf::Member& part : type.parts()) made.push_back(value_of(part.type));
        return made;
      }
      case idf::TypeKind::kObject:
      case idf::TypeKind::kPose: {
        idf::Dict made;
        for (const idf::Member& part : type.parts()) made.set(part.name, value_of(part.type));
        return made;
      }
      default:
        return array_of(type);
    }
  }

  bool chance(size_t of) { return values_.below(of) == 0; }

 private:
  idf::ElementType element() {
    return *idf::element_type_from_code(static_cast<uint8_t>(1 + values_.below(10)));
  }
  idf::ElementType real() {
    return chance(2) ? idf::ElementType::kFloat32 : idf::ElementType::kFloat64;
  }
  int64_t size() { return chance(3) ? idf::kFreeSize : static_cast<int64_t>(values_.below(4)); }
  idf::Quantity quantity() {
    idf::Quantity made;
    if (chance(3)) made.unit = "m";
    if (chance(3)) made.minimum = static_cast<double>(values_.below(4));
    if (chance(3)) made.maximum = static_cast<double>(10 + values_.below(5));
    return made;
  }

  idf::Type required(int depth) {
    switch (values_.below(depth > 0 ? 21 : 16)) {
      case 0:
        return idf::Type::int32(quantity());
      case 1:
        return idf::Type::int64(quantity());
      case 2:
        return idf::Type::float32(quantity());
      case 3:
        return idf::Type::float64(quantity());
      case 4:
        return idf::Type::string();
      case 5:
        return idf::Type::boolean();
      case 6:
        return idf::Type::time();
      case 7:
        return idf::Type::memory_link();
      case 8:
        return idf::Type::int_enum("Mode", {{"A", 3, "doc"}, {"B", -1}});
      case 9: {
        idf::Shape shape;
        for (size_t rank = values_.below(4); rank > 0; --rank) shape.push_back(size());
        return idf::Type::ndarray(element(), std::move(shape), quantity());
      }
      case 10:
        return idf::Type::matrix(size(), size(), element(), quantity());
      case 11:
        return idf::Type::quaternion(real());
      case 12:
        return idf::Type::orientation(real());
      case 13:
        return idf::Type::pose(real());
      case 14:
        return idf::Type::image(static_cast<idf::PixelType>(values_.below(4)), size(), size());
      case 15:
        return idf::Type::point_cloud(static_cast<idf::PointType>(values_.below(8)), size());
      case 16:
        return idf::Type::list(type(depth - 1), size());
      case 17:
        return idf::Type::dict(type(depth - 1));
      case 18:
        return idf::Type::pair(type(depth - 1), type(depth - 1));
      case 19: {
        std::vector<idf::Type> elements;
        for (size_t count = values_.below(4); count > 0; --count)
          elements.push_back(type(depth - 1));
        return idf::Type::tuple(std::move(elements));
      }
      default:
        return object(depth);
    }
  }

  idf::Type object(int depth) {
    const auto members = [&](std::string_view prefix) {
      std::vector<idf::Member> made;
      for (size_t count = values_.below(4); count > 0; --count)
        made.push_back({std::string(prefix) + std::to_string(count) + values_.key(),
                        type(depth - 1), chance(3) ? "doc" : ""});
      return made;
    };
    const idf::Type base = idf::Type::object("test::Base", members("a"));
    if (chance(2)) return base;
    return idf::Type::object("test::Derived", members("b"), base);
  }

  template <typename T>
  T number(const idf::Quantity& quantity) {
    if (!quantity.is_bounded()) return static_cast<T>(values_.bits() % 127);
    const double low = quantity.minimum.value_or(quantity.maximum.value_or(0) - 5);
    const double high = quantity.maximum.value_or(low + 5);
    const double min = std::is_unsigned_v<T> ? std::max(low, 0.0) : low;
    return static_cast<T>(min +
                          static_cast<double>(values_.below(static_cast<size_t>(high - min) + 1)));
  }

  idf::Data rotation(idf::ElementType element) {
    const double angle = static_cast<double>(values_.below(1000)) / 100;
    const std::vector<double> wxyz{std::cos(angle), std::sin(angle), 0, 0};
    if (element == idf::ElementType::kFloat64) return idf::NdArray::take<double>({4}, wxyz);
    return idf::NdArray::take<float>({4}, std::vector<float>(wxyz.begin(), wxyz.end()));
  }

  idf::Data array_of(const idf::Type& type) {
    const idf::ArrayType array = *type.as_array();
    idf::Shape shape = array.shape;
    size_t count = 1;
    for (int64_t& axis : shape) {
      if (axis == idf::kFreeSize) axis = static_cast<int64_t>(values_.below(12));
      count *= static_cast<size_t>(axis);
    }
    const idf::Quantity quantity = type.quantity() == nullptr ? idf::Quantity{} : *type.quantity();
    const auto filled = [&]<typename T>(T) -> idf::Data {
      std::vector<T> elements(count);
      for (T& element : elements) element = number<T>(quantity);
      return idf::NdArray::take<T>(std::move(shape), std::move(elements));
    };
    switch (array.element) {
      case idf::ElementType::kInt8:
        return filled(int8_t{});
      case idf::ElementType::kInt16:
        return filled(int16_t{});
      case idf::ElementType::kInt32:
        return filled(int32_t{});
      case idf::ElementType::kInt64:
        return filled(int64_t{});
      case idf::ElementType::kUInt8:
        return filled(uint8_t{});
      case idf::ElementType::kUInt16:
        return filled(uint16_t{});
      case idf::ElementType::kUInt32:
        return filled(uint32_t{});
      case idf::ElementType::kUInt64:
        return filled(uint64_t{});
      case idf::ElementType::kFloat32:
        return filled(float{});
      case idf::ElementType::kFloat64:
        break;
    }
    return filled(double{});
  }

  idf::Data list_of(const idf::Type& type) {
    const auto& list = type.get<idf::types::List>();
    const size_t count =
        list.size == idf::kFreeSize ? values_.below(4) : static_cast<size_t>(list.size);
    idf::List made;
    for (size_t i = 0; i < count; ++i) made.push_back(value_of(list.element));
    return made;
  }

  idf::Data dict_of(const idf::Type& type) {
    idf::Dict made;
    for (size_t count = values_.below(4); count > 0; --count)
      made.set(values_.key(), value_of(type.get<idf::types::Dict>().element));
    return made;
  }

  RandomValues values_;
};

namespace idf {
// What GoogleTest prints where types differ.
inline void PrintTo(const Type& type, std::ostream* out) {
  *out << to_string(type);
}
}  // namespace idf

inline std::string text_of(const std::vector<idf::Mismatch>& mismatches) {
  std::string text;
  for (const idf::Mismatch& mismatch : mismatches) text += mismatch.to_string() + "\n";
  return text;
}

inline std::string text_of(const std::vector<idf::CastNote>& notes) {
  std::string text;
  for (const idf::CastNote& note : notes) text += note.to_string() + "\n";
  return text;
}

}  // namespace engram
