// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/cast.h"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include "ltm/idf/convert_elements.h"
#include "ltm/idf/place.h"

namespace engram::idf {

namespace {

using Kind = CastNote::Kind;

/// A leaf value in the kind of its type; nothing where it does not fit.
using Taken = std::optional<Converted<Data>>;

template <typename To>
Taken number_as(const Data& value) {
  return std::visit(
      []<typename From>(const From& from) -> Taken {
        if constexpr (std::is_arithmetic_v<From> && !std::same_as<From, bool>) {
          if (const auto converted = convert_number<To>(from))
            return Converted<Data>{Data(converted->value), converted->is_exact};
        }
        return std::nullopt;
      },
      value.value());
}

/// An array whose shape fits, converted to the element type.
Taken array_as(const Data& value, const ArrayType& needed) {
  const NdArray* array = value.get_if<NdArray>();
  if (array == nullptr || !needed.admits(array->shape())) return std::nullopt;
  auto converted = convert_array(*array, needed.element);
  if (!converted) return std::nullopt;
  return Converted<Data>{Data(std::move(converted->value)), converted->is_exact};
}

Taken take_leaf(const Data& value, const Type& type) {
  switch (type.kind()) {
    case TypeKind::kInt:
    case TypeKind::kIntEnum:
      return number_as<int32_t>(value);
    case TypeKind::kLong:
    case TypeKind::kTime:
      return number_as<int64_t>(value);
    case TypeKind::kFloat:
      return number_as<float>(value);
    case TypeKind::kDouble:
      return number_as<double>(value);
    default:
      break;
  }
  if (const auto array = type.as_array()) return array_as(value, *array);
  return Converted<Data>{value};
}

class Caster {
 public:
  Data cast(const Data& value, const Type& type, const Place& place) {
    if (type.is_optional() && value.is<None>()) return value;
    switch (type.kind()) {
      case TypeKind::kList:
        return cast_list(value, type.get<types::List>(), type, place);
      case TypeKind::kDict:
        return cast_dict(value, type.get<types::Dict>(), type, place);
      case TypeKind::kTuple:
      case TypeKind::kPair:
        return cast_elements(value, type, place);
      case TypeKind::kPose:
        return cast_members(value, type.parts(), type, place);
      case TypeKind::kObject:
        return cast_members(value, type.get<types::Object>().members, type, place);
      default:
        return cast_leaf(value, type, place);
    }
  }

  std::vector<CastNote> notes;

 private:
  void note(Kind kind, const Place& place, std::string found, std::string needed) {
    notes.push_back({kind, {place.path(), std::move(found), std::move(needed)}});
  }

  Data mismatch(const Data& value, const Type& type, const Place& place) {
    note(Kind::kMismatch, place, describe(value), describe(type));
    return default_of(type);
  }

  Data missing(const Type& type, const Place& place) {
    if (!type.is_optional()) note(Kind::kMissing, place, "nothing", describe(type));
    return default_of(type);
  }

  /// Creates the default once per type: a long list of misfits then shares the arrays of one
  /// default.
  const Data& default_of(const Type& type) {
    const auto known = defaults_.find(&type.value());
    if (known != defaults_.end()) return known->second;
    return defaults_.emplace(&type.value(), default_value(type)).first->second;
  }

  Data cast_leaf(const Data& value, const Type& type, const Place& place) {
    auto taken = take_leaf(value, type);
    if (!taken) return mismatch(value, type, place);
    // Checks after the conversion, because rounding may lead out of the bounds.
    if (auto wrong = check_leaf(taken->value, type)) {
      note(Kind::kMismatch, place, std::move(wrong->found), std::move(wrong->needed));
      return default_of(type);
    }
    if (!taken->is_exact) note(Kind::kNarrowed, place, describe(value), describe(type));
    return std::move(taken->value);
  }

  Data cast_list(const Data& value, const types::List& list_type, const Type& type,
                 const Place& place) {
    const List* list = value.get_if<List>();
    if (list == nullptr) return mismatch(value, type, place);
    const bool is_free = list_type.size == kFreeSize;
    const size_t size = is_free ? list->size() : static_cast<size_t>(list_type.size);
    List made;
    made.reserve(size);
    for (size_t i = 0; i < size; ++i) made.push_back(element(*list, i, list_type.element, place));
    drop_from(*list, size, type, place);
    return made;
  }

  Data cast_elements(const Data& value, const Type& type, const Place& place) {
    const List* list = value.get_if<List>();
    if (list == nullptr) return mismatch(value, type, place);
    const std::vector<Member> parts = type.parts();
    List made;
    for (size_t i = 0; i < parts.size(); ++i)
      made.push_back(element(*list, i, parts[i].type, place));
    drop_from(*list, parts.size(), type, place);
    return made;
  }

  Data element(const List& list, size_t index, const Type& type, const Place& place) {
    const Place inner(place, index);
    return index < list.size() ? cast(list[index], type, inner) : missing(type, inner);
  }

  void drop_from(const List& list, size_t first, const Type& type, const Place& place) {
    for (size_t i = first; i < list.size(); ++i)
      note(Kind::kUnknown, Place(place, i), describe(list[i]), describe(type));
  }

  Data cast_dict(const Data& value, const types::Dict& dict_type, const Type& type,
                 const Place& place) {
    const Dict* dict = value.get_if<Dict>();
    if (dict == nullptr) return mismatch(value, type, place);
    Dict made;
    made.reserve(dict->size());
    for (const auto& [key, part] : *dict)
      made.append_unique(key, cast(part, dict_type.element, Place(place, key)));
    return made;
  }

  Data cast_members(const Data& value, const std::vector<Member>& members, const Type& type,
                    const Place& place) {
    const Dict* dict = value.get_if<Dict>();
    if (dict == nullptr) return mismatch(value, type, place);
    Dict made;
    made.reserve(members.size());
    size_t found = 0;
    for (const Member& member : members) {
      const Place inner(place, member.name);
      const Data* part = dict->find(member.name);
      if (part != nullptr) ++found;
      made.append_unique(member.name, part == nullptr ? missing(member.type, inner)
                                                      : cast(*part, member.type, inner));
    }
    if (found < dict->size()) drop_unknown(*dict, members, type, place);
    return made;
  }

  void drop_unknown(const Dict& dict, const std::vector<Member>& members, const Type& type,
                    const Place& place) {
    std::unordered_set<std::string_view> names;
    for (const Member& member : members) names.insert(member.name);
    for (const auto& [key, part] : dict)
      if (!names.contains(key))
        note(Kind::kUnknown, Place(place, key), describe(part),
             "no such member in " + describe(type));
  }

  std::unordered_map<const TypeValue*, Data> defaults_;
};

}  // namespace

std::string_view to_string(CastNote::Kind kind) {
  switch (kind) {
    case Kind::kMismatch:
      return "mismatch";
    case Kind::kMissing:
      return "missing";
    case Kind::kUnknown:
      return "dropped";
    case Kind::kNarrowed:
      break;
  }
  return "narrowed";
}

std::string CastNote::to_string() const {
  return fmt::format("{}: {}", idf::to_string(kind), what.to_string());
}

CastResult cast(const Data& value, const Type& type) {
  Caster caster;
  Data made = caster.cast(value, type, Place());
  return {std::move(made), std::move(caster.notes)};
}

}  // namespace engram::idf
