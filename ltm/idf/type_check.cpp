// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/type_check.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "ltm/core/utf8.h"
#include "ltm/idf/element_visit.h"
#include "ltm/idf/place.h"
#include "ltm/idf/quantity.h"

namespace engram::idf {

namespace {

constexpr size_t kShownText = 40;
constexpr size_t kShownMismatches = 5;

std::string bounds_text(const Quantity& quantity) {
  return fmt::format("{}..{}", quantity.minimum ? fmt::format("{}", *quantity.minimum) : "",
                     quantity.maximum ? fmt::format("{}", *quantity.maximum) : "");
}

std::string array_text(ElementType element, const Shape& shape) {
  std::string text;
  for (const int64_t size : shape)
    text += (text.empty() ? "" : ", ") + (size == kFreeSize ? "*" : std::to_string(size));
  return fmt::format("ndarray {} [{}]", to_string(element), text);
}

std::string shortened(const std::string& text) {
  return text.size() <= kShownText ? text : std::string(cut_utf8(text, kShownText)) + "...";
}

using Found = std::optional<Mismatch>;

Found differs(std::string found, std::string needed) {
  return Mismatch{"", std::move(found), std::move(needed)};
}

template <typename T>
Found check_number(const Data& value, const Quantity& quantity) {
  const T* number = value.get_if<T>();
  if (number == nullptr) return differs(describe(value), Data(T{}).kind_name().data());
  if (is_within(quantity, *number)) return std::nullopt;
  return differs(describe(value), bounds_text(quantity));
}

template <typename T>
Found check_is(const Data& value, std::string_view needed) {
  if (value.is<T>()) return std::nullopt;
  return differs(describe(value), std::string(needed));
}

/// The first element that is out of bounds, and the number of such elements.
Found check_elements(const NdArray& array, const Quantity& quantity) {
  if (!quantity.is_bounded()) return std::nullopt;
  return visit_element_type(array.type(), [&]<typename T>(T) -> Found {
    const auto values = array.values<T>();
    size_t count = 0;
    size_t first = 0;
    for (size_t i = values.size(); i > 0; --i) {
      if (is_within(quantity, values[i - 1])) continue;
      ++count;
      first = i - 1;
    }
    if (count == 0) return std::nullopt;
    return differs(fmt::format("{} of {} elements out of bounds, first element {} = {}", count,
                               values.size(), first, values[first]),
                   bounds_text(quantity));
  });
}

Found check_unit(const NdArray& array) {
  return visit_element_type(array.type(), [&]<typename T>(T) -> Found {
    double sum = 0;
    for (const T value : array.values<T>())
      sum += static_cast<double>(value) * static_cast<double>(value);
    const double norm = std::sqrt(sum);
    if (std::abs(norm - 1) <= kUnitTolerance) return std::nullopt;
    return differs(fmt::format("a quaternion of norm {}", norm), "norm 1");
  });
}

struct LeafChecker {
  const Data& value;
  const Type& type;

  Found operator()(const types::Int& t) const { return check_number<int32_t>(value, t.quantity); }
  Found operator()(const types::Long& t) const { return check_number<int64_t>(value, t.quantity); }
  Found operator()(const types::Float& t) const { return check_number<float>(value, t.quantity); }
  Found operator()(const types::Double& t) const { return check_number<double>(value, t.quantity); }
  Found operator()(const types::String&) const { return check_is<std::string>(value, "string"); }
  Found operator()(const types::Bool&) const { return check_is<bool>(value, "bool"); }
  Found operator()(const types::Time&) const { return check_is<int64_t>(value, "int64 (Time)"); }
  Found operator()(const types::MemoryLink&) const {
    return check_is<std::string>(value, "string (MemoryLink)");
  }
  Found operator()(const types::IntEnum& t) const {
    const int32_t* number = value.get_if<int32_t>();
    if (number != nullptr && t.find(*number) != nullptr) return std::nullopt;
    return differs(describe(value), describe(type));
  }
  template <typename T>
  Found operator()(const T&) const {
    const auto needed = type.as_array();
    if (!needed) return std::nullopt;
    const NdArray* array = value.get_if<NdArray>();
    if (array == nullptr || array->type() != needed->element || !needed->admits(array->shape()))
      return differs(describe(value), describe(type));
    if (const Quantity* quantity = type.quantity()) return check_elements(*array, *quantity);
    return type.kind() == TypeKind::kOrientation ? check_unit(*array) : std::nullopt;
  }
};

class Checker {
 public:
  void check(const Data& value, const Type& type, const Place& place) {
    if (type.is_optional() && value.is<None>()) return;
    switch (type.kind()) {
      case TypeKind::kList:
        return check_list(value, type.get<types::List>(), type, place);
      case TypeKind::kDict:
        return check_dict(value, type.get<types::Dict>(), type, place);
      case TypeKind::kTuple:
      case TypeKind::kPair:
        return check_elements(value, type, place);
      case TypeKind::kPose:
        return check_members(value, type.parts(), type, place);
      case TypeKind::kObject:
        return check_members(value, type.get<types::Object>().members, type, place);
      default:
        if (auto found = check_leaf(value, type)) report(place, std::move(*found));
    }
  }

  std::vector<Mismatch> mismatches;

 private:
  void report(const Place& place, Mismatch mismatch) {
    mismatch.path = place.path();
    mismatches.push_back(std::move(mismatch));
  }
  void report(const Place& place, std::string found, std::string needed) {
    report(place, Mismatch{"", std::move(found), std::move(needed)});
  }

  void check_list(const Data& value, const types::List& list_type, const Type& type,
                  const Place& place) {
    const List* list = value.get_if<List>();
    if (list == nullptr) return report(place, describe(value), describe(type));
    if (list_type.size != kFreeSize && list->size() != static_cast<size_t>(list_type.size))
      report(place, describe(value), describe(type));
    for (size_t i = 0; i < list->size(); ++i) check((*list)[i], list_type.element, Place(place, i));
  }

  void check_dict(const Data& value, const types::Dict& dict_type, const Type& type,
                  const Place& place) {
    const Dict* dict = value.get_if<Dict>();
    if (dict == nullptr) return report(place, describe(value), describe(type));
    for (const auto& [key, element] : *dict) check(element, dict_type.element, Place(place, key));
  }

  void check_elements(const Data& value, const Type& type, const Place& place) {
    const List* list = value.get_if<List>();
    const std::vector<Member> parts = type.parts();
    if (list == nullptr || list->size() != parts.size())
      report(place, describe(value), describe(type));
    for (size_t i = 0; list != nullptr && i < std::min(parts.size(), list->size()); ++i)
      check((*list)[i], parts[i].type, Place(place, i));
  }

  void check_members(const Data& value, const std::vector<Member>& members, const Type& type,
                     const Place& place) {
    const Dict* dict = value.get_if<Dict>();
    if (dict == nullptr) return report(place, describe(value), describe(type));
    MemberFinder finder(*dict);
    size_t found = 0;
    for (const Member& member : members) {
      const Place inner(place, member.name);
      const Data* part = finder.find(member.name);
      if (part == nullptr) {
        report(inner, "nothing", describe(member.type));
        continue;
      }
      ++found;
      check(*part, member.type, inner);
    }
    if (found == dict->size()) return;
    // Names are collected only after a mismatch: usual values never pay for them.
    std::unordered_set<std::string_view> names;
    for (const Member& member : members) names.insert(member.name);
    for (const auto& [key, part] : *dict)
      if (!names.contains(key))
        report(Place(place, key), describe(part), "no such member in " + describe(type));
  }

  /// Finds members. They mostly have the order of their type, so it tries the next key before it
  /// searches.
  class MemberFinder {
   public:
    explicit MemberFinder(const Dict& dict) : dict_(dict), next_(dict.begin()) {}

    const Data* find(std::string_view key) {
      if (next_ != dict_.end() && next_->key == key) return &(next_++)->value;
      return dict_.find(key);
    }

   private:
    const Dict& dict_;
    std::vector<DictEntry>::const_iterator next_;
  };
};

}  // namespace

std::string Mismatch::to_string() const {
  return fmt::format("'{}': found {}, needs {}", path, found, needed);
}

std::vector<Mismatch> check(const Data& value, const Type& type) {
  Checker checker;
  checker.check(value, type, Place());
  return std::move(checker.mismatches);
}

Status to_status(const std::vector<Mismatch>& mismatches) {
  if (mismatches.empty()) return {};
  std::string text;
  for (size_t i = 0; i < std::min(mismatches.size(), kShownMismatches); ++i)
    text += (text.empty() ? "" : "; ") + mismatches[i].to_string();
  if (mismatches.size() > kShownMismatches)
    text += fmt::format("; and {} more", mismatches.size() - kShownMismatches);
  return invalid_argument("{}", text);
}

std::string describe(const Data& value) {
  return std::visit(
      [&value]<typename T>(const T& held) -> std::string {
        if constexpr (std::is_arithmetic_v<T>)
          return fmt::format("{} {}", value.kind_name(), held);
        else if constexpr (std::same_as<T, std::string>)
          return fmt::format("string '{}'", shortened(held));
        else if constexpr (std::same_as<T, NdArray>)
          return array_text(held.type(), held.shape());
        else if constexpr (std::same_as<T, List> || std::same_as<T, Dict>)
          return fmt::format("{} of {}", value.kind_name(), held.size());
        else
          return std::string(value.kind_name());
      },
      value.value());
}

std::string describe(const Type& type) {
  if (const auto array = type.as_array()) return array_text(array->element, array->shape);
  switch (type.kind()) {
    case TypeKind::kInt:
      return "int32";
    case TypeKind::kLong:
      return "int64";
    case TypeKind::kFloat:
      return "float32";
    case TypeKind::kDouble:
      return "float64";
    case TypeKind::kString:
      return "string";
    case TypeKind::kBool:
      return "bool";
    case TypeKind::kTime:
      return "int64 (Time)";
    case TypeKind::kMemoryLink:
      return "string (MemoryLink)";
    case TypeKind::kIntEnum:
      return fmt::format("int32 of {}", to_string(type.required()));
    case TypeKind::kTuple:
    case TypeKind::kPair:
      return fmt::format("list of {} ({})", type.parts().size(), to_string(type.kind()));
    case TypeKind::kDict:
      return "dict";
    case TypeKind::kPose:
      return "dict (Pose)";
    case TypeKind::kObject:
      return fmt::format("dict (Object {})", type.name());
    default:
      break;
  }
  const int64_t size = type.get<types::List>().size;
  return size == kFreeSize ? "list" : fmt::format("list of {}", size);
}

std::optional<Mismatch> check_leaf(const Data& value, const Type& type) {
  return std::visit(LeafChecker{value, type}, type.value());
}

}  // namespace engram::idf
