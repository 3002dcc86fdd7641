// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/layout.h"

#include <algorithm>
#include <cstring>

#include "ltm/idf/layout_skeleton.h"

namespace engram::idf {

namespace {

constexpr int64_t kSmallestImage = 8;
constexpr MemberKind kLastKind = MemberKind::kPointCloud;

bool is_image(const NdArray& array) {
  const Shape& shape = array.shape();
  if (shape.size() != 3 || shape[0] < kSmallestImage || shape[1] < kSmallestImage) return false;
  if (array.type() == ElementType::kUInt8) return shape[2] == 3 || shape[2] == 1;
  return array.type() == ElementType::kUInt16 && shape[2] == 1;
}

/// The member for `value`; nothing where it belongs to the remainder or is a dict.
std::optional<TensorMember> member_of(const Data& value) {
  if (value.is<bool>()) return TensorMember{"", MemberKind::kBool, ElementType::kUInt8, {}};
  if (const NdArray* array = value.get_if<NdArray>())
    return TensorMember{"", is_image(*array) ? MemberKind::kImage : MemberKind::kArray,
                        array->type(), array->shape()};
  return std::visit(
      []<typename T>(const T&) -> std::optional<TensorMember> {
        if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>)
          return TensorMember{"", MemberKind::kNumber, kElementTypeOf<T>, {}};
        else
          return std::nullopt;
      },
      value.value());
}

Data place_of(const TensorMember& member) {
  List place{static_cast<int32_t>(member.kind), static_cast<int32_t>(member.type)};
  for (const int64_t size : member.shape) place.emplace_back(size);
  return place;
}

/// True for the element types that the tensor of a bool or number can have.
bool is_scalar_type(const TensorMember& member) {
  if (member.kind == MemberKind::kBool) return member.type == ElementType::kUInt8;
  return member.type == ElementType::kInt32 || member.type == ElementType::kInt64 ||
         member.type == ElementType::kFloat32 || member.type == ElementType::kFloat64;
}

std::optional<TensorMember> member_of_place(const List& place) {
  if (place.size() < 2) return std::nullopt;
  const auto* kind = place[0].get_if<int32_t>();
  const auto* code = place[1].get_if<int32_t>();
  if (kind == nullptr || code == nullptr || *kind < 0 || *kind > static_cast<int32_t>(kLastKind) ||
      *code < 0 || *code > UINT8_MAX)
    return std::nullopt;
  const auto type = element_type_from_code(static_cast<uint8_t>(*code));
  if (!type) return std::nullopt;
  TensorMember member{"", static_cast<MemberKind>(*kind), *type, {}};
  for (size_t i = 2; i < place.size(); ++i) {
    const auto* size = place[i].get_if<int64_t>();
    if (size == nullptr || *size < 0) return std::nullopt;
    member.shape.push_back(*size);
  }
  const bool is_scalar = member.kind == MemberKind::kBool || member.kind == MemberKind::kNumber;
  if (is_scalar && (!member.shape.empty() || !is_scalar_type(member))) return std::nullopt;
  if (!size_bytes(member.type, member.shape)) return std::nullopt;
  return member;
}

Data skeleton_of(const Data& value) {
  if (const auto member = member_of(value)) return place_of(*member);
  const Dict* dict = value.get_if<Dict>();
  if (dict == nullptr) return None{};
  Dict skeleton;
  skeleton.reserve(dict->size());
  for (const auto& [key, child] : *dict) skeleton.append_unique(key, skeleton_of(child));
  return skeleton;
}

/// The places of a list that is split; null where `skeleton` is none.
const List* walked_list(const Data& skeleton) {
  const List* list = skeleton.get_if<List>();
  return list != nullptr && !list->empty() && list->front() == Data(kWalkedList) ? list : nullptr;
}

bool is_remainder(const Data& skeleton) {
  return skeleton.is<None>() || skeleton == Data(kAnyRemainder);
}

/// True where a value of `found` fits `expected`. Kinds that only a type tells are arrays in
/// `found`.
bool is_same_member(const TensorMember& found, const TensorMember& expected) {
  const auto is_scalar = [](MemberKind kind) {
    return kind == MemberKind::kBool || kind == MemberKind::kNumber;
  };
  if (is_scalar(found.kind) || is_scalar(expected.kind))
    return found.kind == expected.kind && found.type == expected.type;
  return found.type == expected.type && found.shape == expected.shape;
}

Status collect_members(const Data& skeleton, const std::string& path,
                       std::vector<TensorMember>& members) {
  if (const List* places = walked_list(skeleton)) {
    for (size_t i = 1; i < places->size(); ++i)
      ENGRAM_RETURN_IF_ERROR(
          collect_members((*places)[i], join_path(path, std::to_string(i - 1)), members));
  } else if (const List* place = skeleton.get_if<List>()) {
    auto member = member_of_place(*place);
    if (!member) return data_loss("layout: broken tensor member at '{}'", path);
    member->path = path;
    members.push_back(std::move(*member));
  } else if (const Dict* dict = skeleton.get_if<Dict>()) {
    for (const auto& [key, child] : *dict)
      ENGRAM_RETURN_IF_ERROR(collect_members(child, join_path(path, key), members));
  } else if (!is_remainder(skeleton)) {
    return data_loss("layout: found {} at '{}', needs none, list or dict", skeleton.kind_name(),
                     path);
  }
  return {};
}

NdArray tensor_of(const Data& value) {
  return std::visit(
      []<typename T>(const T& held) -> NdArray {
        if constexpr (std::is_same_v<T, bool>)
          return NdArray::take<uint8_t>({}, {static_cast<uint8_t>(held)});
        else if constexpr (std::is_arithmetic_v<T>)
          return NdArray::take<T>({}, {held});
        else if constexpr (std::is_same_v<T, NdArray>)
          return held;
        else
          return NdArray();
      },
      value.value());
}

template <typename T>
Data scalar_of(const NdArray& tensor) {
  return Data(tensor.values<T>()[0]);
}

/// The value of `tensor`, whose type and shape were already compared with the member.
Result<Data> value_of(const TensorMember& member, const NdArray& tensor) {
  switch (member.kind) {
    case MemberKind::kBool:
      return Data(tensor.values<uint8_t>()[0] != 0);
    case MemberKind::kArray:
    case MemberKind::kImage:
    case MemberKind::kDepth:
    case MemberKind::kPosition:
    case MemberKind::kOrientation:
    case MemberKind::kPointCloud:
      return Data(tensor);
    case MemberKind::kNumber:
      break;
  }
  switch (member.type) {
    case ElementType::kInt32:
      return scalar_of<int32_t>(tensor);
    case ElementType::kInt64:
      return scalar_of<int64_t>(tensor);
    case ElementType::kFloat32:
      return scalar_of<float>(tensor);
    case ElementType::kFloat64:
      return scalar_of<double>(tensor);
    default:
      return invalid_argument("layout: no scalar of type {}", to_string(member.type));
  }
}

class Splitter {
 public:
  explicit Splitter(const std::vector<TensorMember>& members) : members_(members) {}

  Status split(const Data& skeleton, const Data& value, const std::string& path) {
    if (const Dict* places = skeleton.get_if<Dict>()) {
      const Dict* dict = value.get_if<Dict>();
      if (dict == nullptr || dict->size() != places->size()) return differs(path, value);
      // Keys are compared in their order, without a search: values of one layout have one order.
      auto entry = dict->begin();
      for (const auto& [key, place] : *places) {
        if (entry->key != key) return differs(join_path(path, key), value);
        ENGRAM_RETURN_IF_ERROR(split(place, entry->value, join_path(path, key)));
        ++entry;
      }
      return {};
    }
    if (const List* places = walked_list(skeleton)) return split_list(*places, value, path);
    if (skeleton == Data(kAnyRemainder)) {
      parts.remainder.push_back(value);
      return {};
    }
    auto member = member_of(value);
    if (skeleton.is<None>()) {
      if (member || value.is<Dict>()) return differs(path, value);
      parts.remainder.push_back(value);
      return {};
    }
    const TensorMember& expected = members_[parts.tensors.size()];
    if (!member || !is_same_member(*member, expected)) return differs(path, value);
    parts.tensors.push_back(tensor_of(value));
    return {};
  }

  SplitValue parts;

 private:
  Status split_list(const List& places, const Data& value, const std::string& path) {
    const List* list = value.get_if<List>();
    if (list == nullptr || list->size() != places.size() - 1) return differs(path, value);
    for (size_t i = 0; i < list->size(); ++i)
      ENGRAM_RETURN_IF_ERROR(split(places[i + 1], (*list)[i], join_path(path, std::to_string(i))));
    return {};
  }

  static Status differs(const std::string& path, const Data& found) {
    return invalid_argument("value at '{}': found {}, which the layout does not have there", path,
                            found.kind_name());
  }

  const std::vector<TensorMember>& members_;
};

class Joiner {
 public:
  Joiner(const std::vector<TensorMember>& members, const SplitValue& parts)
      : members_(members), parts_(parts) {}

  Result<Data> join(const Data& skeleton) {
    if (const Dict* places = skeleton.get_if<Dict>()) {
      Dict dict;
      dict.reserve(places->size());
      for (const auto& [key, place] : *places) {
        ENGRAM_ASSIGN_OR_RETURN(Data value, join(place));
        dict.append_unique(key, std::move(value));
      }
      return Data(std::move(dict));
    }
    if (const List* places = walked_list(skeleton)) {
      List list;
      list.reserve(places->size() - 1);
      for (size_t i = 1; i < places->size(); ++i) {
        ENGRAM_ASSIGN_OR_RETURN(Data value, join((*places)[i]));
        list.push_back(std::move(value));
      }
      return Data(std::move(list));
    }
    if (is_remainder(skeleton)) return parts_.remainder[rest_++];
    const TensorMember& member = members_[tensor_];
    return value_of(member, parts_.tensors[tensor_++]);
  }

  [[nodiscard]] size_t remainder_used() const { return rest_; }

 private:
  const std::vector<TensorMember>& members_;
  const SplitValue& parts_;
  size_t tensor_ = 0;
  size_t rest_ = 0;
};

/// A skeleton with every place of a member replaced by change(place, path).
template <typename Change>
Data changed_places(const Data& skeleton, const std::string& path, const Change& change) {
  if (const List* places = walked_list(skeleton)) {
    List list{kWalkedList};
    list.reserve(places->size());
    for (size_t i = 1; i < places->size(); ++i)
      list.push_back(changed_places((*places)[i], join_path(path, std::to_string(i - 1)), change));
    return Data(std::move(list));
  }
  if (skeleton.is<List>()) return change(skeleton, path);
  const Dict* dict = skeleton.get_if<Dict>();
  if (dict == nullptr) return skeleton;
  Dict result;
  result.reserve(dict->size());
  for (const auto& [key, place] : *dict)
    result.append_unique(key, changed_places(place, join_path(path, key), change));
  return Data(std::move(result));
}

size_t count_remainder(const Data& skeleton) {
  if (is_remainder(skeleton)) return 1;
  size_t count = 0;
  if (const List* places = walked_list(skeleton))
    for (size_t i = 1; i < places->size(); ++i) count += count_remainder((*places)[i]);
  if (const Dict* dict = skeleton.get_if<Dict>())
    for (const auto& [key, place] : *dict) count += count_remainder(place);
  return count;
}

}  // namespace

std::string_view to_string(MemberKind kind) {
  switch (kind) {
    case MemberKind::kBool:
      return "bool";
    case MemberKind::kNumber:
      return "number";
    case MemberKind::kArray:
      return "array";
    case MemberKind::kImage:
      return "image";
    case MemberKind::kDepth:
      return "depth";
    case MemberKind::kPosition:
      return "position";
    case MemberKind::kOrientation:
      return "orientation";
    case MemberKind::kPointCloud:
      return "point cloud";
  }
  return "unknown";
}

Layout Layout::of(const Data& value) {
  auto layout = from_data(skeleton_of(value));
  ENGRAM_CHECK(layout.ok(), "{}", layout.status().message());
  return std::move(layout).value();
}

Layout Layout::with_kinds_of(const Layout& other) const {
  const auto refined = [&](const Data& place, const std::string& path) {
    auto member = member_of_place(*place.get_if<List>());
    const auto known = std::ranges::find(other.members_, path, &TensorMember::path);
    if (!member || known == other.members_.end() || !is_same_member(*known, *member)) return place;
    return place_of(*known);
  };
  auto layout = from_data(changed_places(skeleton_, "", refined));
  ENGRAM_CHECK(layout.ok(), "{}", layout.status().message());
  return std::move(layout).value();
}

Layout Layout::with_remainder(const std::vector<std::string>& paths) const {
  const auto moved = [&](const Data& place, const std::string& path) {
    return std::ranges::find(paths, path) == paths.end() ? place : Data(kAnyRemainder);
  };
  auto layout = from_data(changed_places(skeleton_, "", moved));
  ENGRAM_CHECK(layout.ok(), "{}", layout.status().message());
  return std::move(layout).value();
}

Result<Layout> Layout::from_data(const Data& data) {
  Layout layout(data);
  ENGRAM_RETURN_IF_ERROR(collect_members(data, "", layout.members_));
  return layout;
}

Result<SplitValue> Layout::split(const Data& value) const {
  Splitter splitter(members_);
  splitter.parts.tensors.reserve(members_.size());
  ENGRAM_RETURN_IF_ERROR(splitter.split(skeleton_, value, ""));
  return std::move(splitter.parts);
}

Result<Data> Layout::join(const SplitValue& parts) const {
  if (parts.tensors.size() != members_.size())
    return invalid_argument("layout: found {} tensors, needs {}", parts.tensors.size(),
                            members_.size());
  for (size_t i = 0; i < members_.size(); ++i)
    if (parts.tensors[i].type() != members_[i].type ||
        parts.tensors[i].shape() != members_[i].shape)
      return invalid_argument("layout: member '{}': found {} {}, needs {} {}", members_[i].path,
                              to_string(parts.tensors[i].type()),
                              to_string(parts.tensors[i].shape()), to_string(members_[i].type),
                              to_string(members_[i].shape));
  const size_t places = count_remainder(skeleton_);
  if (parts.remainder.size() != places)
    return invalid_argument("layout: found a remainder of {} values, needs {}",
                            parts.remainder.size(), places);
  return Joiner(members_, parts).join(skeleton_);
}

}  // namespace engram::idf
