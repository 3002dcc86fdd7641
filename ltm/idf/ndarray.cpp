// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/ndarray.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include <fmt/ranges.h>

namespace engram::idf {

namespace {

struct ElementInfo {
  ElementType type;
  std::string_view name;
  size_t size;
};

constexpr std::array<ElementInfo, 10> kElements{{{ElementType::kInt8, "int8", 1},
                                                 {ElementType::kInt16, "int16", 2},
                                                 {ElementType::kInt32, "int32", 4},
                                                 {ElementType::kInt64, "int64", 8},
                                                 {ElementType::kUInt8, "uint8", 1},
                                                 {ElementType::kUInt16, "uint16", 2},
                                                 {ElementType::kUInt32, "uint32", 4},
                                                 {ElementType::kUInt64, "uint64", 8},
                                                 {ElementType::kFloat32, "float32", 4},
                                                 {ElementType::kFloat64, "float64", 8}}};

const ElementInfo& info(ElementType type) { return kElements[static_cast<size_t>(type) - 1]; }

}  // namespace

std::string_view to_string(ElementType type) { return info(type).name; }

size_t size_bytes(ElementType type) { return info(type).size; }

std::optional<ElementType> element_type_from_name(std::string_view name) {
  for (const ElementInfo& element : kElements)
    if (element.name == name) return element.type;
  return std::nullopt;
}

std::optional<ElementType> element_type_from_code(uint8_t code) {
  if (code < 1 || code > kElements.size()) return std::nullopt;
  return static_cast<ElementType>(code);
}

std::string to_string(const Shape& shape) { return fmt::format("[{}]", fmt::join(shape, ", ")); }

std::optional<size_t> size_bytes(ElementType type, const Shape& shape) {
  if (std::ranges::any_of(shape, [](int64_t size) { return size < 0; })) return std::nullopt;
  // Independent of the order of the axes: [2^40, 2^40, 0] has no bytes.
  if (std::ranges::find(shape, 0) != shape.end()) return 0;
  size_t total = size_bytes(type);
  for (const int64_t size : shape) {
    if (__builtin_mul_overflow(total, static_cast<size_t>(size), &total)) return std::nullopt;
  }
  return total;
}

NdArray::NdArray() : shape_{0} {}

Result<NdArray> NdArray::create(ElementType type, Shape shape, Buffer buffer) {
  const auto needed = idf::size_bytes(type, shape);
  if (!needed || *needed != buffer.size())
    return invalid_argument("ndarray {} {}: found {} bytes, needs {}", to_string(type),
                            to_string(shape), buffer.size(),
                            needed ? std::to_string(*needed) : "a shape that 64 bits can count");
  if (reinterpret_cast<uintptr_t>(buffer.data()) % idf::size_bytes(type) != 0)
    return invalid_argument("ndarray {} {}: the buffer is not aligned to {} bytes",
                            to_string(type), to_string(shape), idf::size_bytes(type));
  return NdArray(type, std::move(shape), std::move(buffer));
}

int64_t NdArray::count() const {
  return static_cast<int64_t>(buffer_.size() / idf::size_bytes(type_));
}

bool operator==(const NdArray& a, const NdArray& b) {
  return a.type_ == b.type_ && a.shape_ == b.shape_ && std::ranges::equal(a.bytes(), b.bytes());
}

}  // namespace engram::idf
