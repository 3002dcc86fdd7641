// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/generate_python_member.h"

#include <fmt/format.h>

#include "ltm/idf/generate_python_names.h"

namespace engram::idf {

namespace {

std::string joined_hints(const Type& type) {
  std::string text;
  for (const Member& part : type.parts())
    text += (text.empty() ? "" : ", ") + python_hint(part.type);
  return text.empty() ? "()" : text;
}

std::string required_hint(const Type& type) {
  if (!type.name().empty()) return python_class_name(type.name());
  if (const auto array = type.as_array())
    return fmt::format("NDArray[np.{}]", to_string(array->element));
  switch (type.kind()) {
    case TypeKind::kInt:
    case TypeKind::kLong:
    case TypeKind::kTime:
      return "int";
    case TypeKind::kFloat:
    case TypeKind::kDouble:
      return "float";
    case TypeKind::kBool:
      return "bool";
    case TypeKind::kPose:
      return "idf.Pose";
    case TypeKind::kList:
      return fmt::format("list[{}]", joined_hints(type));
    case TypeKind::kDict:
      return fmt::format("dict[str, {}]", joined_hints(type));
    case TypeKind::kTuple:
    case TypeKind::kPair:
      return fmt::format("tuple[{}]", joined_hints(type));
    default:
      return "str";
  }
}

/// Needs at least one bound.
std::string bounds_in_python(const Quantity& quantity) {
  if (!quantity.maximum) return fmt::format(" At least {}.", *quantity.minimum);
  if (!quantity.minimum) return fmt::format(" At most {}.", *quantity.maximum);
  return fmt::format(" Range: {}..{}.", *quantity.minimum, *quantity.maximum);
}

std::string shape_text(const Type& type, const ArrayType& array) {
  std::string text;
  for (const int64_t size : array.shape)
    text += (text.empty() ? "" : ", ") + (size == kFreeSize ? "*" : std::to_string(size));
  switch (type.kind()) {
    case TypeKind::kQuaternion:
    case TypeKind::kOrientation:
      return " Shape: [4], w x y z.";
    case TypeKind::kImage:
      return fmt::format(" Shape: [{}], {}.", text, to_string(type.get<types::Image>().pixel));
    case TypeKind::kPointCloud:
      return fmt::format(" Shape: [{}], {}.", text, to_string(type.get<types::PointCloud>().point));
    default:
      return fmt::format(" Shape: [{}].", text);
  }
}

std::string unit_text(const Type& type) {
  if (const auto* image = type.get_if<types::Image>()) {
    if (image->pixel == PixelType::kDepth32) return " Unit: m.";
    return image->pixel == PixelType::kDepth16 ? " Unit: mm." : "";
  }
  if (type.kind() == TypeKind::kPointCloud || type.kind() == TypeKind::kPose) return " Unit: m.";
  const Quantity* quantity = type.quantity();
  return quantity == nullptr || quantity->unit.empty() ? ""
                                                       : fmt::format(" Unit: {}.", quantity->unit);
}

/// "Frame: takes camera coordinates to world." for `pose_world_camera`.
std::string frame_text(std::string_view name) {
  constexpr std::string_view kPrefix = "pose_";
  if (!name.starts_with(kPrefix)) return "";
  name.remove_prefix(kPrefix.size());
  const size_t middle = name.find('_');
  if (middle == 0 || middle == std::string_view::npos || middle + 1 == name.size()) return "";
  if (name.find('_', middle + 1) != std::string_view::npos) return "";
  return fmt::format(" Frame: takes {} coordinates to {}.", name.substr(middle + 1),
                     name.substr(0, middle));
}

/// The facts of the type beyond its hint, each sentence after a space.
std::string facts(const Type& type, std::string_view name) {
  std::string text;
  if (const auto array = type.as_array()) text += shape_text(type, *array);
  text += unit_text(type);
  if (const Quantity* quantity = type.quantity(); quantity != nullptr && quantity->is_bounded())
    text += bounds_in_python(*quantity);
  if (type.kind() == TypeKind::kTime) text += " Time: ns since the Unix epoch, UTC.";
  if (type.kind() == TypeKind::kMemoryLink) text += " A printed MemoryID; empty: no link.";
  if (type.kind() == TypeKind::kPose) text += frame_text(name);
  if (const auto* list = type.get_if<types::List>()) {
    if (list->size != kFreeSize) text += fmt::format(" Size: {}.", list->size);
    text += facts(list->element, name);
  }
  if (const auto* dict = type.get_if<types::Dict>()) text += facts(dict->element, name);
  return text;
}

}  // namespace

std::string python_hint(const Type& type) {
  return required_hint(type) + (type.is_optional() ? " | None" : "");
}

std::string python_member_doc(const Member& member) {
  std::string text = member.doc;
  // An object or enum has its documentation at its own class.
  if (member.type.name().empty() && !member.type.doc().empty())
    text += (text.empty() ? "" : "\n") + member.type.doc();
  const std::string more = facts(member.type, member.name);
  if (more.empty()) return text;
  return text.empty() ? more.substr(1) : text + "\n" + more.substr(1);
}

}  // namespace engram::idf
