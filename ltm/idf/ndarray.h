// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/buffer.h"
#include "ltm/core/status.h"

namespace engram::idf {

/// The type of one element of an ndarray. The values are part of the binary form: never renumber.
enum class ElementType : uint8_t {
  kInt8 = 1,
  kInt16 = 2,
  kInt32 = 3,
  kInt64 = 4,
  kUInt8 = 5,
  kUInt16 = 6,
  kUInt32 = 7,
  kUInt64 = 8,
  kFloat32 = 9,
  kFloat64 = 10,
};

/// The names of NumPy: "uint8", "float32", ...
[[nodiscard]] std::string_view to_string(ElementType type);
[[nodiscard]] std::optional<ElementType> element_type_from_name(std::string_view name);
[[nodiscard]] std::optional<ElementType> element_type_from_code(uint8_t code);
[[nodiscard]] size_t size_bytes(ElementType type);

template <typename T>
inline constexpr ElementType kElementTypeOf = [] {
  static_assert(sizeof(T) == 0, "no element type");
  return ElementType::kInt8;
}();
template <> inline constexpr ElementType kElementTypeOf<int8_t> = ElementType::kInt8;
template <> inline constexpr ElementType kElementTypeOf<int16_t> = ElementType::kInt16;
template <> inline constexpr ElementType kElementTypeOf<int32_t> = ElementType::kInt32;
template <> inline constexpr ElementType kElementTypeOf<int64_t> = ElementType::kInt64;
template <> inline constexpr ElementType kElementTypeOf<uint8_t> = ElementType::kUInt8;
template <> inline constexpr ElementType kElementTypeOf<uint16_t> = ElementType::kUInt16;
template <> inline constexpr ElementType kElementTypeOf<uint32_t> = ElementType::kUInt32;
template <> inline constexpr ElementType kElementTypeOf<uint64_t> = ElementType::kUInt64;
template <> inline constexpr ElementType kElementTypeOf<float> = ElementType::kFloat32;
template <> inline constexpr ElementType kElementTypeOf<double> = ElementType::kFloat64;

/// The sizes of the axes, slowest first. Empty: one element.
using Shape = std::vector<int64_t>;

/// Prints "[128, 128, 3]".
[[nodiscard]] std::string to_string(const Shape& shape);

/// The number of bytes of a dense array; nothing if a size is negative or 64 bits overflow.
[[nodiscard]] std::optional<size_t> size_bytes(ElementType type, const Shape& shape);

/// A dense row-major array over a shared immutable buffer; copying is O(1).
///
/// Images are uint8 [H, W, 3] in RGB order or uint8 [H, W, 1].
/// Threading: immutable.
class NdArray {
 public:
  /// An empty array: uint8 [0].
  NdArray();

  /// Errors: kInvalidArgument if `buffer` does not have exactly the bytes of type and shape, or is
  /// not aligned to the element.
  static Result<NdArray> create(ElementType type, Shape shape, Buffer buffer);

  /// Takes `values` without a copy. The shape must have exactly their number of elements (checked).
  template <typename T>
  static NdArray take(Shape shape, std::vector<T> values) {
    auto array = create(kElementTypeOf<T>, std::move(shape), Buffer::take(std::move(values)));
    ENGRAM_CHECK(array.ok(), "{}", array.status().message());
    return std::move(array).value();
  }

  [[nodiscard]] ElementType type() const { return type_; }
  [[nodiscard]] const Shape& shape() const { return shape_; }
  [[nodiscard]] size_t rank() const { return shape_.size(); }
  [[nodiscard]] int64_t count() const;
  [[nodiscard]] const Buffer& buffer() const { return buffer_; }
  [[nodiscard]] std::span<const std::byte> bytes() const { return buffer_.bytes(); }

  /// The elements; T must be the element type (checked).
  template <typename T>
  [[nodiscard]] std::span<const T> values() const {
    ENGRAM_CHECK(kElementTypeOf<T> == type_, "array has {}", to_string(type_));
    return {reinterpret_cast<const T*>(buffer_.data()), buffer_.size() / sizeof(T)};
  }

  /// Equality is bit-wise: equal type, shape and bytes. NaNs with equal bits are equal.
  friend bool operator==(const NdArray& a, const NdArray& b);

 private:
  NdArray(ElementType type, Shape shape, Buffer buffer)
      : type_(type), shape_(std::move(shape)), buffer_(std::move(buffer)) {}

  ElementType type_ = ElementType::kUInt8;
  Shape shape_;
  Buffer buffer_;
};

}  // namespace engram::idf
