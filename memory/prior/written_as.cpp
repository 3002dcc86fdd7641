// SPDX-License-Identifier: Apache-2.0
#include "memory/prior/written_as.h"

#include <algorithm>

#include "ltm/core/time.h"

namespace engram::memory {

using idf::Data;
using idf::Dict;
using idf::List;
using idf::NdArray;
using idf::Type;
using idf::TypeKind;

namespace {

/// Collects the numbers of nested lists; read() is false where they make no array.
class ArrayReader {
 public:
  bool read(const Data& value, size_t axis) {
    const List* list = value.get_if<List>();
    if (list == nullptr) return read_number(value, axis);
    if (is_leaf_known_ && axis >= shape.size()) return false;
    const auto size = static_cast<int64_t>(list->size());
    if (axis == shape.size())
      shape.push_back(size);
    else if (shape[axis] != size)
      return false;
    return std::ranges::all_of(*list, [&](const Data& element) { return read(element, axis + 1); });
  }

  idf::Shape shape;
  std::vector<double> numbers;
  std::vector<int64_t> integers;  ///< As many as `numbers` where all are integers.

 private:
  bool read_number(const Data& value, size_t axis) {
    // as_number() would take true as 1, and the check of the type could not report it any more.
    if (value.is<bool>() || !value.as_number() || axis != shape.size()) return false;
    is_leaf_known_ = true;
    numbers.push_back(*value.as_number());
    if (const auto* integer = value.get_if<int64_t>()) integers.push_back(*integer);
    return true;
  }

  bool is_leaf_known_ = false;
};

Data array_of(Data value) {
  if (!value.is<List>()) return value;
  ArrayReader reader;
  if (!reader.read(value, 0)) return value;
  // Integers stay exact; the cast to the type comes later.
  if (reader.integers.size() == reader.numbers.size() && !reader.integers.empty())
    return NdArray::take(std::move(reader.shape), std::move(reader.integers));
  return NdArray::take(std::move(reader.shape), std::move(reader.numbers));
}

Data enum_value_of(const idf::types::IntEnum& type, Data value) {
  const auto* name = value.get_if<std::string>();
  if (name == nullptr) return value;
  const auto found = std::ranges::find(type.values, *name, &idf::EnumValue::name);
  return found == type.values.end() ? value : Data(found->value);
}

Data time_of(Data value) {
  const auto* text = value.get_if<std::string>();
  if (text == nullptr) return value;
  const auto time = parse_time(*text);
  return time.ok() ? Data(to_ns(*time)) : value;
}

Data dict_of(const Type& type, Data value) {
  const Dict* dict = value.get_if<Dict>();
  if (dict == nullptr) return value;
  const auto parts = type.parts();
  Dict made;
  made.reserve(dict->size());
  for (const auto& [key, member] : *dict) {
    // A dict type has one part without a name, which holds for all keys.
    const auto part = std::ranges::find_if(
        parts, [&](const idf::Member& one) { return one.name.empty() || one.name == key; });
    made.append_unique(key, part == parts.end() ? member : written_as(part->type, member));
  }
  return made;
}

Data list_of(const Type& type, Data value) {
  const List* list = value.get_if<List>();
  if (list == nullptr) return value;
  const auto parts = type.parts();
  List made;
  made.reserve(list->size());
  for (size_t i = 0; i < list->size(); ++i) {
    const bool is_same = type.kind() == TypeKind::kList;
    const size_t part = is_same ? 0 : i;
    made.push_back(part < parts.size() ? written_as(parts[part].type, (*list)[i]) : (*list)[i]);
  }
  return made;
}

}  // namespace

Data written_as(const Type& type, Data value) {
  if (type.as_array()) return array_of(std::move(value));
  switch (type.kind()) {
    case TypeKind::kIntEnum:
      return enum_value_of(type.get<idf::types::IntEnum>(), std::move(value));
    case TypeKind::kTime:
      return time_of(std::move(value));
    case TypeKind::kObject:
    case TypeKind::kDict:
    case TypeKind::kPose:
      return dict_of(type, std::move(value));
    case TypeKind::kList:
    case TypeKind::kTuple:
    case TypeKind::kPair:
      return list_of(type, std::move(value));
    default:
      return value;
  }
}

}  // namespace engram::memory
