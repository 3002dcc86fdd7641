// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/type.h"

#include <algorithm>
#include <unordered_set>

#include "ltm/idf/element_visit.h"
#include "ltm/idf/quantity.h"

namespace engram::idf {

struct Type::Node {
  TypeValue value;
  bool is_optional = false;
  std::string doc;
  int depth = 1;
  size_t nodes = 1;
  size_t default_bytes = 0;
};

namespace {

constexpr size_t kMaxNodes = size_t{1} << 20;
constexpr size_t kMaxDefaultBytes = size_t{1} << 30;
constexpr size_t kMaxTypeRank = 16;

/// Adds, but stops at SIZE_MAX instead of wrapping.
size_t add(size_t a, size_t b) {
  size_t sum = 0;
  return __builtin_add_overflow(a, b, &sum) ? SIZE_MAX : sum;
}

size_t multiply(size_t a, size_t b) {
  size_t product = 0;
  return __builtin_mul_overflow(a, b, &product) ? SIZE_MAX : product;
}

template <typename T>
Status check_bounds(const Quantity& quantity) {
  const auto is_number = [](std::optional<double> bound) {
    return !bound || std::isfinite(*bound);
  };
  if (!is_number(quantity.minimum) || !is_number(quantity.maximum))
    return invalid_argument("a bound is not finite");
  if (!closest_to_zero<T>(quantity))
    return invalid_argument("no {} lies within the bounds {}..{}", to_string(kElementTypeOf<T>),
                            quantity.minimum.value_or(-HUGE_VAL),
                            quantity.maximum.value_or(HUGE_VAL));
  return {};
}

Status check_sizes(const Shape& sizes) {
  for (const int64_t size : sizes)
    if (size < 0 && size != kFreeSize)
      return invalid_argument("size {}: needs zero or more, or {} for a free one", size, kFreeSize);
  if (sizes.size() > kMaxTypeRank)
    return invalid_argument("has {} axes, at most {} are known", sizes.size(), kMaxTypeRank);
  return {};
}

Status check_float(ElementType element) {
  if (element == ElementType::kFloat32 || element == ElementType::kFloat64) return {};
  return invalid_argument("element type {}: needs float32 or float64", to_string(element));
}

/// Checks that `names` are unique; `what` names their owner in the error.
template <typename Range>
Status check_unique(const Range& range, std::string_view what) {
  std::unordered_set<std::string_view> seen;
  for (const auto& entry : range)
    if (!seen.insert(entry.name).second)
      return invalid_argument("{} '{}' is there twice", what, entry.name);
  return {};
}

/// Checks an alternative and fills its derived members.
struct Completer {
  Status operator()(types::Int& type) const { return check_bounds<int32_t>(type.quantity); }
  Status operator()(types::Long& type) const { return check_bounds<int64_t>(type.quantity); }
  Status operator()(types::Float& type) const { return check_bounds<float>(type.quantity); }
  Status operator()(types::Double& type) const { return check_bounds<double>(type.quantity); }
  Status operator()(types::IntEnum& type) const {
    if (type.values.empty()) return invalid_argument("has no value, needs one at least");
    std::unordered_set<int32_t> seen;
    for (const EnumValue& value : type.values)
      if (!seen.insert(value.value).second)
        return invalid_argument("value {} has two names", value.value);
    return check_unique(type.values, "name");
  }
  Status operator()(types::NdArray& type) const {
    ENGRAM_RETURN_IF_ERROR(check_sizes(type.shape));
    return check_array(type.element, type.quantity);
  }
  Status operator()(types::Matrix& type) const {
    ENGRAM_RETURN_IF_ERROR(check_sizes({type.rows, type.cols}));
    return check_array(type.element, type.quantity);
  }
  Status operator()(types::Quaternion& type) const { return check_float(type.element); }
  Status operator()(types::Orientation& type) const { return check_float(type.element); }
  Status operator()(types::Pose& type) const { return check_float(type.element); }
  Status operator()(types::Image& type) const { return check_sizes({type.height, type.width}); }
  Status operator()(types::PointCloud& type) const { return check_sizes({type.count}); }
  Status operator()(types::List& type) const { return check_sizes({type.size}); }
  Status operator()(types::Object& type) const {
    type.members.clear();
    if (type.base) {
      const auto* base = type.base->get_if<types::Object>();
      if (base == nullptr || type.base->is_optional())
        return invalid_argument("extends {}, needs an Object that is not optional",
                                to_string(type.base->kind()));
      type.members = base->members;
    }
    type.members.insert(type.members.end(), type.own_members.begin(), type.own_members.end());
    return check_unique(type.members, "member");
  }
  template <typename T>
  Status operator()(T&) const {
    return {};
  }

 private:
  static Status check_array(ElementType element, const Quantity& quantity) {
    return visit_element_type(element, [&]<typename T>(T) { return check_bounds<T>(quantity); });
  }
};

std::vector<Member> numbered(const std::vector<Type>& elements) {
  std::vector<Member> parts;
  for (size_t i = 0; i < elements.size(); ++i) parts.push_back({std::to_string(i), elements[i]});
  return parts;
}

std::vector<Member> pose_parts(ElementType element) {
  static const auto make = [](ElementType type) {
    return std::vector<Member>{{std::string(kPositionKey), Type::ndarray(type, {3}, {.unit = "m"})},
                               {std::string(kOrientationKey), Type::orientation(type)}};
  };
  static const std::vector<Member> kFloat = make(ElementType::kFloat32);
  static const std::vector<Member> kDouble = make(ElementType::kFloat64);
  return element == ElementType::kFloat64 ? kDouble : kFloat;
}

ArrayType image_array(const types::Image& image) {
  const auto array = [&](ElementType element, int64_t channels) {
    return ArrayType{element, {image.height, image.width, channels}};
  };
  switch (image.pixel) {
    case PixelType::kRgb24:
      return array(ElementType::kUInt8, 3);
    case PixelType::kMono8:
      return array(ElementType::kUInt8, 1);
    case PixelType::kDepth32:
      return array(ElementType::kFloat32, 1);
    case PixelType::kDepth16:
      break;
  }
  return array(ElementType::kUInt16, 1);
}

struct ArrayOf {
  using Found = std::optional<ArrayType>;
  Found operator()(const types::NdArray& type) const { return {{type.element, type.shape}}; }
  Found operator()(const types::Matrix& type) const {
    return {{type.element, {type.rows, type.cols}}};
  }
  Found operator()(const types::Quaternion& type) const { return {{type.element, {4}}}; }
  Found operator()(const types::Orientation& type) const { return {{type.element, {4}}}; }
  Found operator()(const types::Image& type) const { return image_array(type); }
  Found operator()(const types::PointCloud& type) const {
    return {{ElementType::kFloat32, {type.count, field_count(type.point)}}};
  }
  template <typename T>
  Found operator()(const T&) const {
    return std::nullopt;
  }
};

struct PartsOf {
  using Parts = std::vector<Member>;
  Parts operator()(const types::List& type) const { return {{"", type.element}}; }
  Parts operator()(const types::Dict& type) const { return {{"", type.element}}; }
  Parts operator()(const types::Tuple& type) const { return numbered(type.elements); }
  Parts operator()(const types::Pair& type) const { return numbered({type.first, type.second}); }
  Parts operator()(const types::Object& type) const { return type.members; }
  Parts operator()(const types::Pose& type) const { return pose_parts(type.element); }
  template <typename T>
  Parts operator()(const T&) const {
    return {};
  }
};

/// The bytes of the array in a default value; free axes are empty.
size_t default_array_bytes(const ArrayType& array) {
  size_t bytes = size_bytes(array.element);
  for (const int64_t size : array.shape)
    bytes = multiply(bytes, size == kFreeSize ? 0 : static_cast<size_t>(size));
  return bytes;
}

/// "Object 'kitchen::Cup'", "Matrix".
std::string title(const TypeValue& value) {
  const std::string_view kind = to_string(static_cast<TypeKind>(value.index()));
  if (const auto* object = std::get_if<types::Object>(&value))
    return fmt::format("{} '{}'", kind, object->name);
  if (const auto* named = std::get_if<types::IntEnum>(&value))
    return fmt::format("{} '{}'", kind, named->name);
  return std::string(kind);
}

}  // namespace

const EnumValue* types::IntEnum::find(int32_t value) const {
  const auto found = std::ranges::find(values, value, &EnumValue::value);
  return found == values.end() ? nullptr : &*found;
}

const Member* types::Object::find(std::string_view member) const {
  const auto found = std::ranges::find(members, member, &Member::name);
  return found == members.end() ? nullptr : &*found;
}

bool ArrayType::is_fixed() const {
  return std::ranges::count(shape, kFreeSize) == 0;
}

bool ArrayType::admits(const Shape& found) const {
  return std::ranges::equal(shape, found, [](int64_t needed, int64_t size) {
    return needed == kFreeSize || needed == size;
  });
}

Result<Type> Type::create(TypeValue value, bool is_optional, std::string doc) {
  const auto refuse = [&value](const Status& status) {
    return status.with_context("type " + title(value));
  };
  if (const Status status = std::visit(Completer{}, value); !status.ok()) return refuse(status);
  Node node{std::move(value), is_optional, std::move(doc)};
  const auto count = [&node](const Type& part, size_t times) {
    node.depth = std::max(node.depth, part.node_->depth + 1);
    node.nodes = add(node.nodes, multiply(times, part.node_->nodes));
    node.default_bytes = add(node.default_bytes, multiply(times, part.node_->default_bytes));
  };
  if (const auto* list = std::get_if<types::List>(&node.value)) {
    count(list->element, list->size == kFreeSize ? 1 : static_cast<size_t>(list->size));
  } else {
    for (const Member& part : std::visit(PartsOf{}, node.value)) count(part.type, 1);
  }
  const auto* object = std::get_if<types::Object>(&node.value);
  if (object != nullptr && object->base) count(*object->base, 0);
  if (const auto array = std::visit(ArrayOf{}, node.value))
    node.default_bytes = default_array_bytes(*array);
  value = std::move(node.value);
  if (node.depth > kMaxTypeDepth)
    return refuse(invalid_argument("nests {} levels deep, at most {} are allowed", node.depth,
                                   kMaxTypeDepth));
  if (node.nodes > kMaxNodes)
    return refuse(
        invalid_argument("needs {} nodes, at most {} are allowed", node.nodes, kMaxNodes));
  if (node.default_bytes > kMaxDefaultBytes)
    return refuse(invalid_argument("its default value has {} bytes, at most {} are allowed",
                                   node.default_bytes, kMaxDefaultBytes));
  node.value = std::move(value);
  return Type(std::make_shared<const Node>(std::move(node)));
}

Type Type::with_optional(bool is_optional) const {
  if (is_optional == node_->is_optional) return *this;
  auto node = std::make_shared<Node>(*node_);
  node->is_optional = is_optional;
  return Type(std::move(node));
}

Type Type::with_doc(std::string doc) const {
  auto node = std::make_shared<Node>(*node_);
  node->doc = std::move(doc);
  return Type(std::move(node));
}

TypeKind Type::kind() const {
  return static_cast<TypeKind>(node_->value.index());
}
bool Type::is_optional() const {
  return node_->is_optional;
}
const std::string& Type::doc() const {
  return node_->doc;
}
const TypeValue& Type::value() const {
  return node_->value;
}
int Type::depth() const {
  return node_->depth;
}
size_t Type::node_count() const {
  return node_->nodes;
}

std::string_view Type::name() const {
  if (const auto* object = get_if<types::Object>()) return object->name;
  if (const auto* named = get_if<types::IntEnum>()) return named->name;
  return {};
}

const Quantity* Type::quantity() const {
  return std::visit(
      [](const auto& type) -> const Quantity* {
        if constexpr (requires { type.quantity; })
          return &type.quantity;
        else
          return nullptr;
      },
      node_->value);
}

std::optional<ArrayType> Type::as_array() const {
  return std::visit(ArrayOf{}, node_->value);
}

std::vector<Member> Type::parts() const {
  return std::visit(PartsOf{}, node_->value);
}

bool operator==(const Type& a, const Type& b) {
  if (a.node_ == b.node_) return true;
  return a.node_->is_optional == b.node_->is_optional && a.node_->doc == b.node_->doc &&
         a.node_->value == b.node_->value;
}

}  // namespace engram::idf
