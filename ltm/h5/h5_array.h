// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace engram::h5 {

enum class Type {
  kInt8,
  kInt16,
  kInt32,
  kInt64,
  kUInt8,
  kUInt16,
  kUInt32,
  kUInt64,
  kFloat32,
  kFloat64
};

[[nodiscard]] size_t size_bytes(Type type);

/// What the elements of an array in a file of other people are.
enum class Kind : uint8_t {
  kNumber,     ///< Of a Type, in any order of bytes.
  kHalf,       ///< A float of two bytes; kFloat32 in memory.
  kBool,       ///< h5py's enumeration FALSE, TRUE of one byte; kUInt8 in memory.
  kFixedText,  ///< Padded to a length.
  kText,       ///< Of variable length.
  kBytes,      ///< uint8 of variable length, such as a compressed image.
  kOther,      ///< Compounds, references, ...: not read.
};

struct Element {
  Kind kind = Kind::kNumber;
  Type type = Type::kUInt8;  ///< In memory; means nothing to texts.
  uint64_t text_bytes = 0;   ///< Of a fixed text.

  [[nodiscard]] bool is_number() const { return kind <= Kind::kBool; }

  friend bool operator==(const Element&, const Element&) = default;
};

/// A dataset of numbers or texts of any kind.
struct ArrayInfo {
  Element element;
  std::vector<uint64_t> shape;  ///< Empty: one element.
  uint64_t chunk_rows = 0;      ///< Rows of a chunk along axis 0; 0: not chunked.
  int deflate_level = 0;        ///< 0: not compressed.

  /// Size of axis 0; 0 where there is none.
  [[nodiscard]] uint64_t rows() const { return shape.empty() ? 0 : shape[0]; }
  [[nodiscard]] uint64_t row_elements() const;
  /// In memory, of numbers. Arrays of opened files were checked not to overflow.
  [[nodiscard]] uint64_t row_bytes() const { return row_elements() * size_bytes(element.type); }

  friend bool operator==(const ArrayInfo&, const ArrayInfo&) = default;
};

/// The value of an attribute.
struct Attribute {
  Element element;
  std::vector<uint64_t> shape;   ///< Empty: one element.
  std::vector<std::byte> bytes;  ///< Of numbers.
  std::vector<std::string> texts;

  friend bool operator==(const Attribute&, const Attribute&) = default;
};

}  // namespace engram::h5
