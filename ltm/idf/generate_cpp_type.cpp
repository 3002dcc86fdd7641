// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/generate_cpp_type.h"

#include <fmt/ranges.h>

#include "ltm/idf/element_visit.h"
#include "ltm/idf/generate_cpp_names.h"
#include "ltm/idf/quantity.h"

namespace engram::idf {

namespace {

/// The bound of elements in place. Larger matrices and arrays are on the heap, because structs are
/// moved and live on stacks.
constexpr int64_t kMaxInPlace = 64;

/// The bound of an axis that Eigen knows at compile time.
constexpr int64_t kMaxFixedAxis = 4096;

std::string element_name(ElementType element) {
  if (element == ElementType::kFloat32) return "float";
  if (element == ElementType::kFloat64) return "double";
  return fmt::format("{}_t", to_string(element));
}

/// The number closest to zero within the bounds; empty where that is zero.
template <typename T>
std::string number_text(const Quantity& quantity) {
  const T value = closest_to_zero<T>(quantity).value_or(T{});
  if (value == T{}) return "";
  if constexpr (std::floating_point<T>)
    return cpp_number(value);
  else if constexpr (std::same_as<T, uint64_t>)
    return cpp_number(value);
  else
    return cpp_number(static_cast<int64_t>(value));
}

std::string number_text(ElementType element, const Quantity& quantity) {
  return visit_element_type(element, [&]<typename T>(T) { return number_text<T>(quantity); });
}

bool is_in_place(const types::List& list) {
  return list.size != kFreeSize && list.size <= kMaxInPlace;
}

/// The rows and columns that are known at compile time; kFreeSize for Eigen::Dynamic.
std::pair<int64_t, int64_t> known_axes(const types::Matrix& matrix) {
  const bool is_fixed = matrix.rows != kFreeSize && matrix.cols != kFreeSize;
  if (is_fixed) {
    const bool fits = matrix.rows > 0 && matrix.cols > 0 && matrix.rows <= kMaxInPlace &&
                      matrix.cols <= kMaxInPlace && matrix.rows * matrix.cols <= kMaxInPlace;
    return fits ? std::pair(matrix.rows, matrix.cols) : std::pair(kFreeSize, kFreeSize);
  }
  const auto known = [](int64_t size) {
    return size > 0 && size <= kMaxFixedAxis ? size : kFreeSize;
  };
  return {known(matrix.rows), known(matrix.cols)};
}

std::string axis_text(int64_t size) {
  return size == kFreeSize ? "Eigen::Dynamic" : std::to_string(size);
}

std::string point_name(PointType point) {
  switch (point) {
    case PointType::kXyz:
      return "kXyz";
    case PointType::kXyzi:
      return "kXyzi";
    case PointType::kXyzl:
      return "kXyzl";
    case PointType::kXyzRgb:
      return "kXyzRgb";
    case PointType::kXyzRgba:
      return "kXyzRgba";
    case PointType::kXyzRgbl:
      return "kXyzRgbl";
    case PointType::kXyzNormal:
      return "kXyzNormal";
    case PointType::kXyzRgbNormal:
      break;
  }
  return "kXyzRgbNormal";
}

std::string mat_type(PixelType pixel) {
  switch (pixel) {
    case PixelType::kRgb24:
      return "CV_8UC3";
    case PixelType::kMono8:
      return "CV_8UC1";
    case PixelType::kDepth32:
      return "CV_32FC1";
    case PixelType::kDepth16:
      break;
  }
  return "CV_16UC1";
}

struct NameOf {
  std::string_view scope;

  std::string operator()(const types::Int&) const { return "int32_t"; }
  std::string operator()(const types::Long&) const { return "int64_t"; }
  std::string operator()(const types::Float&) const { return "float"; }
  std::string operator()(const types::Double&) const { return "double"; }
  std::string operator()(const types::String&) const { return "std::string"; }
  std::string operator()(const types::Bool&) const { return "bool"; }
  std::string operator()(const types::Time&) const { return "engram::Time"; }
  std::string operator()(const types::MemoryLink&) const { return "engram::ltm::MemoryId"; }
  std::string operator()(const types::IntEnum& t) const { return cpp_reference(t.name, scope); }
  std::string operator()(const types::Object& t) const { return cpp_reference(t.name, scope); }
  std::string operator()(const types::NdArray&) const { return "engram::idf::NdArray"; }
  std::string operator()(const types::Matrix& t) const {
    const auto [rows, cols] = known_axes(t);
    return fmt::format("Eigen::Matrix<{}, {}, {}>", element_name(t.element), axis_text(rows),
                       axis_text(cols));
  }
  std::string operator()(const types::Quaternion& t) const { return quaternion(t.element); }
  std::string operator()(const types::Orientation& t) const { return quaternion(t.element); }
  std::string operator()(const types::Pose& t) const {
    return fmt::format("engram::typed::Pose<{}>", element_name(t.element));
  }
  std::string operator()(const types::Image&) const { return "cv::Mat"; }
  std::string operator()(const types::PointCloud& t) const {
    return fmt::format("engram::typed::PointCloud<engram::idf::PointType::{}>",
                       point_name(t.point));
  }
  std::string operator()(const types::List& t) const {
    const std::string element = cpp_type(t.element, scope);
    if (is_in_place(t)) return fmt::format("std::array<{}, {}>", element, t.size);
    return fmt::format("std::vector<{}>", element);
  }
  std::string operator()(const types::Dict& t) const {
    return fmt::format("std::map<std::string, {}, std::less<>>", cpp_type(t.element, scope));
  }
  std::string operator()(const types::Tuple& t) const {
    std::vector<std::string> names;
    for (const Type& element : t.elements) names.push_back(cpp_type(element, scope));
    return fmt::format("std::tuple<{}>", fmt::join(names, ", "));
  }
  std::string operator()(const types::Pair& t) const {
    return fmt::format("std::pair<{}, {}>", cpp_type(t.first, scope), cpp_type(t.second, scope));
  }

 private:
  static std::string quaternion(ElementType element) {
    return fmt::format("Eigen::Quaternion<{}>", element_name(element));
  }
};

/// The initial value where it differs from `T()`; otherwise empty.
struct InitialOf {
  const Type& type;
  std::string_view scope;

  std::string operator()(const types::Int& t) const { return number_text<int32_t>(t.quantity); }
  std::string operator()(const types::Long& t) const { return number_text<int64_t>(t.quantity); }
  std::string operator()(const types::Float& t) const { return number_text<float>(t.quantity); }
  std::string operator()(const types::Double& t) const { return number_text<double>(t.quantity); }
  std::string operator()(const types::IntEnum& t) const {
    return t.values.front().value == 0
               ? ""
               : fmt::format("{}::{}", cpp_reference(t.name, scope), cpp_enumerators(t).front());
  }
  std::string operator()(const types::NdArray& t) const {
    std::vector<int64_t> shape;
    for (const int64_t size : t.shape) shape.push_back(size == kFreeSize ? 0 : size);
    const std::string value = number_text(t.element, t.quantity);
    return fmt::format("engram::typed::filled<{}>({{{}}}{}{})", element_name(t.element),
                       fmt::join(shape, ", "), value.empty() ? "" : ", ", value);
  }
  std::string operator()(const types::Matrix& t) const {
    const auto [rows, cols] = known_axes(t);
    std::string arguments;
    if (rows == kFreeSize || cols == kFreeSize) {
      // Free axes are empty by default.
      if (t.rows <= 0 && t.cols <= 0) return "";
      if (rows == t.rows && cols == t.cols) return "";
      arguments = fmt::format("{}, {}", std::max<int64_t>(t.rows, 0), std::max<int64_t>(t.cols, 0));
    }
    const std::string value = number_text(t.element, t.quantity);
    if (!value.empty()) arguments += (arguments.empty() ? "" : ", ") + value;
    return fmt::format("{}::{}({})", NameOf{scope}(t), value.empty() ? "Zero" : "Constant",
                       arguments);
  }
  std::string operator()(const types::Quaternion& t) const {
    return NameOf{scope}(t) + "::Identity()";
  }
  std::string operator()(const types::Orientation& t) const {
    return NameOf{scope}(t) + "::Identity()";
  }
  std::string operator()(const types::Image& t) const {
    if (t.height <= 0 && t.width <= 0) return "";
    const bool is_fixed = t.height > 0 && t.width > 0;
    return fmt::format("cv::Mat{}({}, {}, {})", is_fixed ? "::zeros" : "",
                       std::max<int64_t>(t.height, 0), std::max<int64_t>(t.width, 0),
                       mat_type(t.pixel));
  }
  std::string operator()(const types::PointCloud& t) const {
    return t.count <= 0 ? "" : fmt::format("{}::zeros({})", NameOf{scope}(t), t.count);
  }
  std::string operator()(const types::List& t) const {
    if (t.size <= 0) return "";
    const std::string element = initial(t.element);
    if (is_in_place(t))
      return element.empty() ? ""
                             : fmt::format("engram::typed::repeated<{}, {}>({})", t.size,
                                           cpp_type(t.element, scope), element);
    return fmt::format("{}({}{}{})", NameOf{scope}(t), t.size, element.empty() ? "" : ", ",
                       element);
  }
  std::string operator()(const types::Tuple& t) const { return all(t.elements); }
  std::string operator()(const types::Pair& t) const { return all({t.first, t.second}); }
  template <typename T>
  std::string operator()(const T&) const {
    return "";
  }

 private:
  [[nodiscard]] std::string initial(const Type& part) const {
    if (part.is_optional()) return "";
    const std::string text = std::visit(InitialOf{part, scope}, part.value());
    return text.starts_with('{') ? cpp_type(part, scope) + text : text;
  }
  [[nodiscard]] std::string all(const std::vector<Type>& parts) const {
    std::vector<std::string> texts;
    bool is_plain = true;
    for (const Type& part : parts) {
      const std::string text = initial(part);
      is_plain = is_plain && text.empty();
      texts.push_back(text.empty() ? cpp_type(part, scope) + "{}" : text);
    }
    return is_plain ? "" : fmt::format("{{{}}}", fmt::join(texts, ", "));
  }
};

std::string elements_text(std::string_view channels, ElementType element, const Shape& shape) {
  std::vector<std::string> sizes;
  for (const int64_t size : shape) sizes.push_back(size == kFreeSize ? "*" : std::to_string(size));
  return fmt::format("Shape: {} [{}]{}. ", to_string(element), fmt::join(sizes, ", "), channels);
}

std::string_view channels_text(PixelType pixel) {
  if (pixel == PixelType::kRgb24) return ", RGB";
  if (pixel == PixelType::kDepth32) return ", depth in m";
  if (pixel == PixelType::kDepth16) return ", depth in mm";
  return ", grey";
}

}  // namespace

std::string cpp_type(const Type& type, std::string_view scope) {
  const std::string name = std::visit(NameOf{scope}, type.value());
  return type.is_optional() ? fmt::format("std::optional<{}>", name) : name;
}

std::string cpp_initial(const Type& type, std::string_view scope) {
  if (type.is_optional()) return "";
  const std::string text = std::visit(InitialOf{type, scope}, type.value());
  if (!text.empty()) return text;
  switch (type.kind()) {
    case TypeKind::kInt:
    case TypeKind::kLong:
      return "0";
    case TypeKind::kFloat:
      return "0.0f";
    case TypeKind::kDouble:
      return "0.0";
    case TypeKind::kBool:
      return "false";
    case TypeKind::kIntEnum: {
      const auto& named = type.get<types::IntEnum>();
      return fmt::format("{}::{}", cpp_reference(named.name, scope),
                         cpp_enumerators(named).front());
    }
    case TypeKind::kList:
      return is_in_place(type.get<types::List>()) ? "{}" : "";
    default:
      return "";
  }
}

std::string cpp_facts(const Type& type) {
  std::string facts;
  if (const Quantity* quantity = type.quantity()) {
    if (!quantity->unit.empty()) facts += fmt::format("Unit: {}. ", quantity->unit);
    if (quantity->minimum && quantity->maximum)
      facts += fmt::format("Range: {}..{}. ", *quantity->minimum, *quantity->maximum);
    else if (quantity->minimum)
      facts += fmt::format("Range: {} or more. ", *quantity->minimum);
    else if (quantity->maximum)
      facts += fmt::format("Range: {} or less. ", *quantity->maximum);
  }
  if (const auto* image = type.get_if<types::Image>()) {
    const ArrayType array = *type.as_array();
    facts += elements_text(channels_text(image->pixel), array.element, array.shape);
  } else if (const auto array = type.as_array();
             array && type.kind() != TypeKind::kQuaternion && type.kind() != TypeKind::kOrientation)
    facts += elements_text("", array->element, array->shape);
  if (const auto* list = type.get_if<types::List>()) {
    if (list->size > kMaxInPlace) facts += fmt::format("Shape: {} elements. ", list->size);
    if (const std::string each = cpp_facts(list->element); !each.empty())
      facts += fmt::format("Of each element: {} ", each);
  }
  if (const auto* dict = type.get_if<types::Dict>())
    if (const std::string each = cpp_facts(dict->element); !each.empty())
      facts += fmt::format("Of each entry: {} ", each);
  if (!facts.empty()) facts.pop_back();
  return facts;
}

void CppHeaders::add(const Type& type) {
  if (type.is_optional()) system.insert("optional");
  switch (type.kind()) {
    case TypeKind::kInt:
    case TypeKind::kLong:
      system.insert("cstdint");
      break;
    case TypeKind::kString:
      system.insert("string");
      break;
    case TypeKind::kTime:
      own.insert("ltm/core/time.h");
      break;
    case TypeKind::kMemoryLink:
      own.insert("ltm/memory/memory_id.h");
      break;
    case TypeKind::kNdArray:
      system.insert("cstdint");
      own.insert("ltm/typed/defaults.h");
      break;
    case TypeKind::kMatrix:
      system.insert("cstdint");
      libraries.insert("Eigen/Core");
      sources.insert("ltm/typed/convert_eigen.h");
      break;
    case TypeKind::kQuaternion:
    case TypeKind::kOrientation:
      libraries.insert("Eigen/Geometry");
      sources.insert("ltm/typed/convert_eigen.h");
      break;
    case TypeKind::kPose:
      own.insert("ltm/typed/pose.h");
      sources.insert("ltm/typed/convert_eigen.h");
      break;
    case TypeKind::kImage:
      libraries.insert("opencv2/core/mat.hpp");
      sources.insert("ltm/typed/image.h");
      break;
    case TypeKind::kPointCloud:
      own.insert("ltm/typed/point_cloud.h");
      break;
    case TypeKind::kList:
      system.insert(is_in_place(type.get<types::List>()) ? "array" : "vector");
      if (is_in_place(type.get<types::List>())) own.insert("ltm/typed/defaults.h");
      break;
    case TypeKind::kDict:
      for (const char* name : {"functional", "map", "string"}) system.emplace(name);
      break;
    case TypeKind::kTuple:
      system.insert("tuple");
      break;
    case TypeKind::kPair:
      system.insert("utility");
      break;
    default:
      break;
  }
  if (!type.name().empty() || type.kind() == TypeKind::kPose) return;
  for (const Member& part : type.parts()) add(part.type);
}

}  // namespace engram::idf
