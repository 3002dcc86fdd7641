// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/shown_value.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "ltm/codec/packed_value.h"
#include "ltm/core/not_a_number.h"
#include "ltm/idf/element_visit.h"
#include "ltm/idf/json.h"
#include "ltm/memory/memory_id.h"

namespace engram::reports {

namespace {

using ValueJson = nlohmann::ordered_json;
using MaybeType = std::optional<idf::Type>;

constexpr int64_t kMaxShownNumbers = 64;
constexpr size_t kMaxShownElements = 1000;
constexpr int64_t kMaxListedNumbers = 4096;
constexpr size_t kMaxMembers = 20'000;

/// The type of a part; nothing where it is not known. Elements of lists and dicts have no names.
MaybeType part_type(const MaybeType& type, std::string_view name) {
  if (!type) return std::nullopt;
  for (const idf::Member& part : type->parts())
    if (part.name == name || part.name.empty()) return part.type;
  return std::nullopt;
}

bool is_link(const std::string& text, const MaybeType& type) {
  if (text.empty()) return false;
  if (type) return type->kind() == idf::TypeKind::kMemoryLink;
  const auto id = ltm::MemoryId::parse(text);
  return id.ok() && id->time();
}

/// "image", "depth", "cloud" or "array".
std::string array_kind(const idf::NdArray& array, const MaybeType& type) {
  // A type alone tells a cloud from a matrix.
  if (type && type->kind() == idf::TypeKind::kPointCloud) return "cloud";
  switch (ltm::medium_kind(array.type(), array.shape())) {
    case ltm::MediumKind::kImage:
      return "image";
    case ltm::MediumKind::kDepth:
      return "depth";
    case ltm::MediumKind::kCloud:
      return type ? "array" : "cloud";
    default:
      return "array";
  }
}

ValueJson number_or_null(double number) {
  return std::isfinite(number) ? ValueJson(number) : ValueJson(nullptr);
}

/// NaNs and infinities are left out.
ValueJson summary_of(const idf::NdArray& array) {
  double min = std::numeric_limits<double>::infinity();
  double max = -min;
  double sum = 0;
  int64_t count = 0;
  idf::visit_element_type(array.type(), [&]<typename T>(T) {
    for (const T element : array.values<T>()) {
      const auto number = static_cast<double>(element);
      if (!std::isfinite(number)) continue;
      min = std::min(min, number);
      max = std::max(max, number);
      sum += number;
      ++count;
    }
  });
  return {{"min", number_or_null(count > 0 ? min : kNaN)},
          {"max", number_or_null(count > 0 ? max : kNaN)},
          {"mean", number_or_null(count > 0 ? sum / static_cast<double>(count) : kNaN)}};
}

/// Writes values whose depth was checked.
Result<ValueJson> shown(const idf::Data& value, const MaybeType& type, const std::string& path) {
  if (const auto* text = value.get_if<std::string>(); text != nullptr && is_link(*text, type))
    return ValueJson{{"$link", *text}};
  if (const auto* array = value.get_if<idf::NdArray>()) {
    const std::string kind = array_kind(*array, type);
    const idf::Shape& shape = array->shape();
    if (kind == "image" || kind == "depth")
      return ValueJson{{"$image",
                        {{"path", path},
                         {"width", shape[1]},
                         {"height", shape[0]},
                         {"channels", shape[2]},
                         {"dtype", to_string(array->type())}}}};
    if (array->count() > kMaxShownNumbers)
      return ValueJson{{"$array",
                        {{"shape", shape},
                         {"dtype", to_string(array->type())},
                         {"summary", summary_of(*array)}}}};
  }
  if (const auto* list = value.get_if<idf::List>()) {
    ValueJson elements = ValueJson::array();
    for (size_t i = 0; i < std::min(list->size(), kMaxShownElements); ++i) {
      const std::string name = std::to_string(i);
      ENGRAM_ASSIGN_OR_RETURN(ValueJson element,
                              shown((*list)[i], part_type(type, name), idf::join_path(path, name)));
      elements.push_back(std::move(element));
    }
    if (list->size() > kMaxShownElements)
      elements.push_back({{"$more", list->size() - kMaxShownElements}});
    return elements;
  }
  if (const auto* dict = value.get_if<idf::Dict>()) {
    ValueJson::object_t object;
    for (const auto& [key, part] : *dict) {
      ENGRAM_ASSIGN_OR_RETURN(ValueJson member,
                              shown(part, part_type(type, key), idf::join_path(path, key)));
      object.emplace_back(key.starts_with('$') ? "$" + key : key, std::move(member));
    }
    return ValueJson(std::move(object));
  }
  return idf::to_json(value);
}

bool is_pose(const idf::Data& value, const MaybeType& type) {
  if (type) return type->kind() == idf::TypeKind::kPose;
  const auto has = [&value](std::string_view key, const idf::Shape& shape) {
    const idf::Data* part = value.at(key);
    const idf::NdArray* array = part == nullptr ? nullptr : part->get_if<idf::NdArray>();
    return array != nullptr && array->shape() == shape;
  };
  return has(idf::kPositionKey, {3}) && has(idf::kOrientationKey, {4});
}

/// "[1,2]" for element 5 of shape [2, 3].
std::string index_text(int64_t element, const idf::Shape& shape) {
  std::string text;
  for (size_t axis = shape.size(); axis-- > 0;) {
    text = std::to_string(element % shape[axis]) + (text.empty() ? "" : "," + text);
    element /= shape[axis];
  }
  return "[" + text + "]";
}

class MemberList {
 public:
  void add(const idf::Data& value, const MaybeType& type, const std::string& path) {
    if (members.size() >= kMaxMembers) return;
    const idf::Quantity* known = type ? type->quantity() : nullptr;
    const auto quantity = known == nullptr ? std::nullopt : std::optional(*known);
    if (value.as_number()) members.push_back({path, "number", {}, quantity});
    if (const auto* text = value.get_if<std::string>())
      members.push_back({path, is_link(*text, type) ? "link" : "text"});
    if (const auto* array = value.get_if<idf::NdArray>()) add_array(*array, type, path, quantity);
    if (const auto* list = value.get_if<idf::List>())
      for (size_t i = 0; i < std::min(list->size(), kMaxShownElements); ++i)
        add_part((*list)[i], type, path, std::to_string(i));
    if (const auto* dict = value.get_if<idf::Dict>()) {
      if (is_pose(value, type)) members.push_back({path, "pose"});
      for (const auto& [key, part] : *dict) add_part(part, type, path, key);
    }
  }

  std::vector<ShownMember> members;

 private:
  void add_part(const idf::Data& part, const MaybeType& type, const std::string& path,
                const std::string& name) {
    add(part, part_type(type, name), idf::join_path(path, name));
  }

  void add_array(const idf::NdArray& array, const MaybeType& type, const std::string& path,
                 const std::optional<idf::Quantity>& quantity) {
    const std::string kind = array_kind(array, type);
    if (kind != "array" || array.count() > kMaxListedNumbers) {
      members.push_back({path, kind, array.shape(), quantity});
      return;
    }
    if (array.rank() == 0) members.push_back({path + "[]", "number", {}, quantity});
    for (int64_t i = 0; array.rank() > 0 && i < array.count(); ++i) {
      if (members.size() >= kMaxMembers) return;
      members.push_back({path + index_text(i, array.shape()), "number", {}, quantity});
    }
  }
};

double element_of(const idf::NdArray& array, int64_t element) {
  return idf::visit_element_type(array.type(), [&]<typename T>(T) {
    return static_cast<double>(array.values<T>()[static_cast<size_t>(element)]);
  });
}

/// The element that "1,2" addresses; nothing where there is none.
std::optional<int64_t> element_at(std::string_view indices, const idf::Shape& shape) {
  int64_t element = 0;
  for (const int64_t size : shape) {
    int64_t index = 0;
    const auto [end, error] =
        std::from_chars(indices.data(), indices.data() + indices.size(), index);
    if (error != std::errc() || index < 0 || index >= size) return std::nullopt;
    element = element * size + index;
    indices.remove_prefix(static_cast<size_t>(end - indices.data()));
    if (indices.starts_with(',')) indices.remove_prefix(1);
  }
  return indices.empty() ? std::optional(element) : std::nullopt;
}

}  // namespace

Result<ValueJson> shown_value(const idf::Data& value, const MaybeType& type) {
  return shown(value, type, "");
}

std::vector<ShownMember> shown_members(const idf::Data& value, const MaybeType& type) {
  MemberList list;
  list.add(value, type, "");
  return std::move(list.members);
}

std::string unit_at(const MaybeType& type, std::string_view path) {
  if (path.ends_with(']')) path = path.substr(0, path.rfind('['));
  MaybeType part = type;
  for (const std::string& name : idf::split_path(path)) part = part_type(part, name);
  const idf::Quantity* quantity = part ? part->quantity() : nullptr;
  return quantity == nullptr ? "" : quantity->unit;
}

double number_at(const idf::Data& value, std::string_view path) {
  if (const idf::Data* whole = value.at(path))
    if (const auto number = whole->as_number()) return *number;
  const size_t bracket = path.rfind('[');
  if (bracket == std::string_view::npos || !path.ends_with(']')) return kNaN;
  const idf::Data* part = value.at(path.substr(0, bracket));
  const idf::NdArray* array = part == nullptr ? nullptr : part->get_if<idf::NdArray>();
  if (array == nullptr || array->count() == 0) return kNaN;
  const auto element =
      element_at(path.substr(bracket + 1, path.size() - bracket - 2), array->shape());
  return element ? element_of(*array, *element) : kNaN;
}

const idf::NdArray* image_at(const idf::Data& value, std::string_view path) {
  const idf::Data* part = value.at(path);
  const idf::NdArray* array = part == nullptr ? nullptr : part->get_if<idf::NdArray>();
  if (array == nullptr) return nullptr;
  const std::string kind = array_kind(*array, std::nullopt);
  return kind == "image" || kind == "depth" ? array : nullptr;
}

}  // namespace engram::reports
