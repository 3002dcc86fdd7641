// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "ltm/idf/type.h"

namespace engram::idf {

namespace {

/// In the order of TypeKind. These names are stored, so that kinds may be reordered.
constexpr std::array<std::string_view, std::variant_size_v<TypeValue>> kKindNames{
    "Int",        "Long",       "Float",   "Double", "String",     "Bool",        "Time",
    "MemoryLink", "IntEnum",    "NDArray", "Matrix", "Quaternion", "Orientation", "Pose",
    "Image",      "PointCloud", "List",    "Tuple",  "Dict",       "Object",      "Pair"};

constexpr std::array<std::string_view, 4> kPixelNames{"rgb24", "mono8", "depth32", "depth16"};

struct PointInfo {
  std::string_view name;
  int64_t fields;
};

constexpr std::array<PointInfo, 8> kPoints{{{"XYZ", 3},
                                            {"XYZI", 4},
                                            {"XYZL", 4},
                                            {"XYZRGB", 6},
                                            {"XYZRGBA", 7},
                                            {"XYZRGBL", 7},
                                            {"XYZNormal", 6},
                                            {"XYZRGBNormal", 9}}};

/// "[m, 0..1]", "[..5]"; empty without unit and bounds.
std::string quantity_text(const Quantity& quantity) {
  std::string text = quantity.unit;
  if (quantity.is_bounded()) {
    if (!text.empty()) text += ", ";
    if (quantity.minimum) text += fmt::format("{}", *quantity.minimum);
    text += "..";
    if (quantity.maximum) text += fmt::format("{}", *quantity.maximum);
  }
  return text.empty() ? text : "[" + text + "]";
}

std::string size_text(int64_t size) {
  return size == kFreeSize ? "*" : std::to_string(size);
}

/// ", 480x640"; empty where all sizes are free.
std::string sizes_text(const Shape& sizes) {
  std::string text;
  bool is_free = true;
  for (const int64_t size : sizes) {
    text += (text.empty() ? ", " : "x") + size_text(size);
    is_free = is_free && size == kFreeSize;
  }
  return is_free ? "" : text;
}

class Printer {
 public:
  Printer(TypeText form, int level) : form_(form), level_(level) {}

  std::string print(const Type& type) const {
    return (type.is_optional() ? "optional " : "") +
           std::visit([this](const auto& value) { return this->text(value); }, type.value());
  }

 private:
  template <typename T>
  static std::string text(const T& value) {
    std::string made(to_string(static_cast<TypeKind>(TypeValue(value).index())));
    if constexpr (requires { value.element; })
      made += fmt::format("<{}>", to_string(value.element));
    if constexpr (requires { value.quantity; }) made += quantity_text(value.quantity);
    return made;
  }
  static std::string text(const types::NdArray& value) {
    std::string shape;
    for (const int64_t size : value.shape) shape += (shape.empty() ? "" : ", ") + size_text(size);
    return fmt::format("NDArray<{}, [{}]>{}", to_string(value.element), shape,
                       quantity_text(value.quantity));
  }
  static std::string text(const types::Matrix& value) {
    return fmt::format("Matrix<{}, {}x{}>{}", to_string(value.element), size_text(value.rows),
                       size_text(value.cols), quantity_text(value.quantity));
  }
  static std::string text(const types::Image& value) {
    return fmt::format("Image<{}{}>", to_string(value.pixel),
                       sizes_text({value.height, value.width}));
  }
  static std::string text(const types::PointCloud& value) {
    return fmt::format("PointCloud<{}{}>", to_string(value.point), sizes_text({value.count}));
  }
  std::string text(const types::IntEnum& value) const {
    std::string made;
    for (const EnumValue& entry : value.values) {
      begin_entry(made);
      made += fmt::format("{} = {}", entry.name, entry.value) + doc_text(entry.doc);
    }
    return "IntEnum " + value.name + braced(made);
  }
  std::string text(const types::List& value) const {
    return fmt::format("List<{}{}>", print(value.element), sizes_text({value.size}));
  }
  std::string text(const types::Dict& value) const { return "Dict<" + print(value.element) + ">"; }
  std::string text(const types::Pair& value) const {
    return fmt::format("Pair<{}, {}>", print(value.first), print(value.second));
  }
  std::string text(const types::Tuple& value) const {
    std::string made;
    for (const Type& element : value.elements) made += (made.empty() ? "" : ", ") + print(element);
    return "Tuple<" + made + ">";
  }
  std::string text(const types::Object& value) const {
    std::string made;
    const Printer inner(form_, level_ + 1);
    for (const Member& member : value.own_members) {
      begin_entry(made);
      made += member.name + ": " + inner.print(member.type) + doc_text(member.doc);
    }
    std::string head = value.name.empty() ? "Object" : value.name;
    if (value.base) head += fmt::format(" extends {}", base_text(*value.base));
    return head + braced(made);
  }

  /// A base is named only in the form with lines; otherwise its members are shown.
  std::string base_text(const Type& base) const {
    return form_ == TypeText::kLines && !base.name().empty() ? std::string(base.name())
                                                             : print(base);
  }

  void begin_entry(std::string& text) const {
    if (form_ == TypeText::kLines)
      text += "\n" + indent(level_ + 1);
    else if (!text.empty())
      text += ", ";
  }
  std::string braced(const std::string& entries) const {
    const bool is_open = form_ == TypeText::kLines && !entries.empty();
    return (form_ == TypeText::kLines ? " {" : "{") + entries +
           (is_open ? "\n" + indent(level_) : "") + "}";
  }
  std::string doc_text(const std::string& doc) const {
    if (form_ == TypeText::kOneLine || doc.empty()) return "";
    std::string text = "  # " + doc;
    for (char& c : text)
      if (c == '\n' || c == '\r') c = ' ';
    return text;
  }
  static std::string indent(int level) { return std::string(static_cast<size_t>(level) * 2, ' '); }

  TypeText form_;
  int level_;
};

}  // namespace

std::string_view to_string(TypeKind kind) {
  return kKindNames[static_cast<size_t>(kind)];
}

std::string_view to_string(PixelType pixel) {
  return kPixelNames[static_cast<size_t>(pixel)];
}

std::optional<PixelType> pixel_type_from_name(std::string_view name) {
  for (size_t i = 0; i < kPixelNames.size(); ++i)
    if (kPixelNames[i] == name) return static_cast<PixelType>(i);
  return std::nullopt;
}

std::string_view to_string(PointType point) {
  return kPoints[static_cast<size_t>(point)].name;
}

int64_t field_count(PointType point) {
  return kPoints[static_cast<size_t>(point)].fields;
}

std::optional<PointType> point_type_from_name(std::string_view name) {
  for (size_t i = 0; i < kPoints.size(); ++i)
    if (kPoints[i].name == name) return static_cast<PointType>(i);
  return std::nullopt;
}

std::string to_string(const Type& type, TypeText form) {
  return Printer(form, 0).print(type);
}

}  // namespace engram::idf
