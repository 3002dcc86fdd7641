// SPDX-License-Identifier: Apache-2.0
#include <charconv>

#include "ltm/idf/type_xml_element.h"

namespace engram::idf {

namespace {

/// The binary form holds no more axes.
constexpr int64_t kMaxXmlRank = 16;

/// Reads "3, -1, 2" as a shape; nothing where an axis is no size.
std::optional<Shape> parse_shape(std::string_view text) {
  Shape shape;
  for (bool is_last = false; !is_last;) {
    const size_t comma = text.find(',');
    is_last = comma == std::string_view::npos;
    std::string_view part = text.substr(0, comma);
    while (part.starts_with(' ')) part.remove_prefix(1);
    while (part.ends_with(' ')) part.remove_suffix(1);
    int64_t size = kFreeSize;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), size);
    const bool is_size = !part.empty() && error == std::errc() &&
                         end == part.data() + part.size() && size >= kFreeSize;
    if (part != "*" && !is_size) return std::nullopt;
    shape.push_back(size);
    if (!is_last) text.remove_prefix(comma + 1);
  }
  return shape;
}

}  // namespace

Result<XmlAttributes> XmlTypeReader::read_attributes(
    const pugi::xml_node& node, std::initializer_list<std::string_view> allowed) {
  return XmlAttributes::read(source_, node, allowed, notes_);
}

Result<TypeValue> XmlTypeReader::read_array(const pugi::xml_node& node, TypeKind kind) {
  switch (kind) {
    case TypeKind::kImage:
      return read_image(node);
    case TypeKind::kPointCloud:
      return read_cloud(node);
    case TypeKind::kMatrix:
      return read_matrix(node);
    case TypeKind::kNdArray:
      return read_ndarray(node);
    default:
      break;
  }
  ENGRAM_ASSIGN_OR_RETURN(const auto attributes,
                          read_attributes(node, {"optional", "doc", "type"}));
  ENGRAM_ASSIGN_OR_RETURN(const ElementType element, attributes.element_type());
  if (kind == TypeKind::kQuaternion) return TypeValue(types::Quaternion{element});
  if (kind == TypeKind::kOrientation) return TypeValue(types::Orientation{element});
  return TypeValue(types::Pose{element});
}

Result<TypeValue> XmlTypeReader::read_position(const pugi::xml_node& node) {
  ENGRAM_RETURN_IF_ERROR(check_empty(node));
  ENGRAM_ASSIGN_OR_RETURN(const auto attributes,
                          read_attributes(node, {"optional", "doc", "type"}));
  ENGRAM_ASSIGN_OR_RETURN(const ElementType element, attributes.element_type());
  return TypeValue(types::NdArray{element, {3}, {.unit = "m"}});
}

Result<TypeValue> XmlTypeReader::read_image(const pugi::xml_node& node) {
  ENGRAM_ASSIGN_OR_RETURN(
      const auto attributes,
      read_attributes(node, {"optional", "doc", "pixeltype", "height", "width"}));
  ENGRAM_ASSIGN_OR_RETURN(const std::string_view name, attributes.get("pixeltype"));
  const auto pixel = pixel_type_from_name(name);
  if (!pixel)
    return source_.error(
        node, fmt::format("pixeltype=\"{}\": needs rgb24, mono8, depth32 or depth16", name));
  types::Image image{*pixel};
  ENGRAM_ASSIGN_OR_RETURN(image.height, attributes.size("height"));
  ENGRAM_ASSIGN_OR_RETURN(image.width, attributes.size("width"));
  return TypeValue(image);
}

Result<TypeValue> XmlTypeReader::read_cloud(const pugi::xml_node& node) {
  ENGRAM_ASSIGN_OR_RETURN(const auto attributes,
                          read_attributes(node, {"optional", "doc", "type", "voxeltype", "count"}));
  // Descriptions may use either attribute, and names with or without "Point" (docs/idf.md).
  ENGRAM_ASSIGN_OR_RETURN(const std::string_view written,
                          attributes.get(attributes.find("voxeltype") ? "voxeltype" : "type"));
  const auto point =
      point_type_from_name(written.starts_with("Point") ? written.substr(5) : written);
  if (!point)
    return source_.error(node, fmt::format("type=\"{}\": needs PointXYZ, PointXYZI, PointXYZL, "
                                           "PointXYZRGB, PointXYZRGBA, PointXYZRGBL, "
                                           "PointXYZNormal or PointXYZRGBNormal",
                                           written));
  ENGRAM_ASSIGN_OR_RETURN(const int64_t count, attributes.size("count"));
  return TypeValue(types::PointCloud{*point, count});
}

Result<TypeValue> XmlTypeReader::read_matrix(const pugi::xml_node& node) {
  ENGRAM_ASSIGN_OR_RETURN(const auto attributes,
                          read_attributes(node, {"optional", "doc", "type", "rows", "cols", "unit",
                                                 "min", "max", "minimum", "maximum"}));
  types::Matrix matrix;
  ENGRAM_ASSIGN_OR_RETURN(matrix.rows, attributes.size("rows"));
  ENGRAM_ASSIGN_OR_RETURN(matrix.cols, attributes.size("cols"));
  ENGRAM_ASSIGN_OR_RETURN(matrix.element, attributes.element_type());
  ENGRAM_ASSIGN_OR_RETURN(matrix.quantity, attributes.quantity());
  return TypeValue(std::move(matrix));
}

Result<TypeValue> XmlTypeReader::read_ndarray(const pugi::xml_node& node) {
  ENGRAM_ASSIGN_OR_RETURN(const auto attributes,
                          read_attributes(node, {"optional", "doc", "type", "shape", "dimensions",
                                                 "unit", "min", "max", "minimum", "maximum"}));
  types::NdArray array;
  ENGRAM_ASSIGN_OR_RETURN(array.element, attributes.element_type());
  ENGRAM_ASSIGN_OR_RETURN(array.quantity, attributes.quantity());
  ENGRAM_ASSIGN_OR_RETURN(const int64_t rank, attributes.size("dimensions"));
  if (const auto text = attributes.find("shape")) {
    const auto shape = parse_shape(*text);
    if (!shape)
      return source_.error(node,
                           fmt::format("shape=\"{}\": needs sizes as in \"3, -1, 2\"", *text));
    if (rank != kFreeSize && rank != static_cast<int64_t>(shape->size()))
      return source_.error(node, fmt::format("dimensions=\"{}\": the shape \"{}\" needs {}", rank,
                                             *text, shape->size()));
    array.shape = *shape;
    return TypeValue(std::move(array));
  }
  if (rank == kFreeSize || rank > kMaxXmlRank)
    return source_.error(node,
                         fmt::format("<NDArray> needs shape=\"3, -1\" or dimensions=\"2\", at "
                                     "most {} axes",
                                     kMaxXmlRank));
  array.shape.assign(static_cast<size_t>(rank), kFreeSize);
  return TypeValue(std::move(array));
}

}  // namespace engram::idf
