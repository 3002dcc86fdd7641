// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/layout.h"
#include "ltm/idf/layout_skeleton.h"
#include "ltm/idf/type.h"

namespace engram::idf {

namespace {

/// The kind of an array that only the type tells; nothing where the value shows it too.
std::optional<MemberKind> kind_of(const Type& type) {
  switch (type.kind()) {
    case TypeKind::kOrientation:
      return MemberKind::kOrientation;
    case TypeKind::kPointCloud:
      return MemberKind::kPointCloud;
    case TypeKind::kImage:
      if (type.get<types::Image>().pixel == PixelType::kDepth32) return MemberKind::kDepth;
      return std::nullopt;
    default:
      return std::nullopt;
  }
}

Data untyped(const Data& value) {
  const Layout layout = Layout::of(value);
  return layout.to_data();
}

Data array_place(MemberKind kind, const NdArray& array) {
  List place{static_cast<int32_t>(kind), static_cast<int32_t>(array.type())};
  for (const int64_t size : array.shape()) place.emplace_back(size);
  return place;
}

class TypedSkeleton {
 public:
  explicit TypedSkeleton(FreeSizes free_sizes) : free_sizes_(free_sizes) {}

  Data of(const Data& value, const Type& type) const {
    // An optional member is absent in some values, and one layout must fit all of them.
    if (type.is_optional()) return kAnyRemainder;
    if (const auto array = type.as_array()) return of_array(value, type, *array);
    switch (type.kind()) {
      case TypeKind::kDict:
        return kAnyRemainder;
      case TypeKind::kPose:
        return of_pose(value, type);
      case TypeKind::kObject:
        return of_members(value, type);
      case TypeKind::kList: {
        const auto& list = type.get<types::List>();
        if (list.size == kFreeSize) return kAnyRemainder;
        return of_list(value, std::vector<Type>(static_cast<size_t>(list.size), list.element));
      }
      case TypeKind::kTuple:
        return of_list(value, type.get<types::Tuple>().elements);
      case TypeKind::kPair:
        return of_list(value, {type.get<types::Pair>().first, type.get<types::Pair>().second});
      default:
        return untyped(value);
    }
  }

 private:
  Data of_array(const Data& value, const Type& type, const ArrayType& needed) const {
    if (!needed.is_fixed() && free_sizes_ == FreeSizes::kRemainder) return kAnyRemainder;
    const NdArray* array = value.get_if<NdArray>();
    const auto kind = kind_of(type);
    if (!kind || array == nullptr || array->type() != needed.element ||
        !needed.admits(array->shape()))
      return untyped(value);
    return array_place(*kind, *array);
  }

  Data of_members(const Data& value, const Type& type) const {
    const Dict* dict = value.get_if<Dict>();
    if (dict == nullptr) return untyped(value);
    const auto& object = type.get<types::Object>();
    Dict skeleton;
    skeleton.reserve(dict->size());
    // In the order of the value and not of the type, because Layout::split compares keys in order.
    for (const auto& [key, part] : *dict) {
      const Member* member = object.find(key);
      skeleton.append_unique(key, member == nullptr ? untyped(part) : of(part, member->type));
    }
    return skeleton;
  }

  Data of_pose(const Data& value, const Type& type) const {
    const Dict* dict = value.get_if<Dict>();
    if (dict == nullptr) return untyped(value);
    const std::vector<Member> parts = type.parts();
    Dict skeleton;
    for (const auto& [key, part] : *dict) {
      if (key == kOrientationKey)
        skeleton.append_unique(key, of(part, parts[1].type));
      else if (key == kPositionKey && is_array(part, *parts[0].type.as_array()))
        skeleton.append_unique(key, array_place(MemberKind::kPosition, *part.get_if<NdArray>()));
      else
        skeleton.append_unique(key, untyped(part));
    }
    return skeleton;
  }

  static bool is_array(const Data& value, const ArrayType& needed) {
    const NdArray* array = value.get_if<NdArray>();
    return array != nullptr && array->type() == needed.element && needed.admits(array->shape());
  }

  Data of_list(const Data& value, const std::vector<Type>& elements) const {
    const List* list = value.get_if<List>();
    if (list == nullptr || list->size() != elements.size()) return untyped(value);
    List skeleton{kWalkedList};
    skeleton.reserve(list->size() + 1);
    for (size_t i = 0; i < list->size(); ++i) skeleton.push_back(of((*list)[i], elements[i]));
    return skeleton;
  }

  FreeSizes free_sizes_;
};

}  // namespace

Layout Layout::of(const Data& value, const Type& type, FreeSizes free_sizes) {
  auto layout = from_data(TypedSkeleton(free_sizes).of(value, type));
  ENGRAM_CHECK(layout.ok(), "{}", layout.status().message());
  return std::move(layout).value();
}

}  // namespace engram::idf
