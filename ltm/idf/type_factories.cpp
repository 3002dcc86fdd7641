// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/type.h"

namespace engram::idf {

namespace {

Type made(TypeValue value) {
  auto type = Type::create(std::move(value));
  // A factory is called with constants of the program, so a wrong one is a bug and no error.
  ENGRAM_CHECK(type.ok(), "{}", type.status().message());
  return std::move(type).value();
}

/// Creates types without fields once and shares them, because code asks for them again and again:
/// copying a type is O(1), creating one is checked and allocates.
template <typename T>
const Type& plain() {
  static const Type kType = made(T{});
  return kType;
}

template <typename T>
Type numeric(Quantity quantity) {
  if (quantity == Quantity{}) return plain<T>();
  return made(T{std::move(quantity)});
}

}  // namespace

Type Type::int32(Quantity quantity) {
  return numeric<types::Int>(std::move(quantity));
}
Type Type::int64(Quantity quantity) {
  return numeric<types::Long>(std::move(quantity));
}
Type Type::float32(Quantity quantity) {
  return numeric<types::Float>(std::move(quantity));
}
Type Type::float64(Quantity quantity) {
  return numeric<types::Double>(std::move(quantity));
}
Type Type::string() {
  return plain<types::String>();
}
Type Type::boolean() {
  return plain<types::Bool>();
}
Type Type::time() {
  return plain<types::Time>();
}
Type Type::memory_link() {
  return plain<types::MemoryLink>();
}

Type Type::int_enum(std::string name, std::vector<EnumValue> values) {
  return made(types::IntEnum{std::move(name), std::move(values)});
}

Type Type::ndarray(ElementType element, Shape shape, Quantity quantity) {
  return made(types::NdArray{element, std::move(shape), std::move(quantity)});
}

Type Type::ndarray_of_rank(ElementType element, size_t rank, Quantity quantity) {
  return ndarray(element, Shape(rank, kFreeSize), std::move(quantity));
}

Type Type::matrix(int64_t rows, int64_t cols, ElementType element, Quantity quantity) {
  return made(types::Matrix{rows, cols, element, std::move(quantity)});
}

Type Type::quaternion(ElementType element) {
  return made(types::Quaternion{element});
}
Type Type::orientation(ElementType element) {
  return made(types::Orientation{element});
}
Type Type::pose(ElementType element) {
  return made(types::Pose{element});
}

Type Type::image(PixelType pixel, int64_t height, int64_t width) {
  return made(types::Image{pixel, height, width});
}

Type Type::point_cloud(PointType point, int64_t count) {
  return made(types::PointCloud{point, count});
}

Type Type::list(const Type& element, int64_t size) {
  return made(types::List{element, size});
}
Type Type::tuple(std::vector<Type> elements) {
  return made(types::Tuple{std::move(elements)});
}
Type Type::dict(const Type& element) {
  return made(types::Dict{element});
}
Type Type::pair(const Type& first, const Type& second) {
  return made(types::Pair{first, second});
}

Type Type::object(std::string name, std::vector<Member> own_members, std::optional<Type> base) {
  return made(types::Object{std::move(name), std::move(own_members), std::move(base), {}});
}

}  // namespace engram::idf
