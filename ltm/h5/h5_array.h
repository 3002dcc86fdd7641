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

/// The kind of the elements of an array in a file that another program wrote.
enum class Kind : uint8_t {
  kNumber,     ///< A number of a Type, in either byte order.
  kHalf,       ///< A 2-byte float; kFloat32 in memory.
  kBool,       ///< h5py's 1-byte enumeration FALSE, TRUE; kUInt8 in memory.
  kFixedText,  ///< Text padded to a fixed length.
  kText,       ///< Text of variable length.
  kBytes,      ///< uint8 of variable length, such as a compressed image.
  kOther,      ///< Compounds, references, and others, which are not read.
};

struct Element {
  Kind kind = Kind::kNumber;
  Type type = Type::kUInt8;  ///< Type in memory; has no meaning for texts.
  uint64_t text_bytes = 0;   ///< Size of a fixed text, in bytes.

  [[nodiscard]] bool is_number() const { return kind <= Kind::kBool; }

  friend bool operator==(const Element&, const Element&) = default;
};

/// A dataset of numbers or texts of any kind.
struct ArrayInfo {
  Element element;
  std::vector<uint64_t> shape;  ///< Empty: one element.
  uint64_t chunk_rows = 0;      ///< Number of rows of a chunk along axis 0; 0 if not chunked.
  int deflate_level = 0;        ///< 0 if not compressed.

  /// Size of axis 0; 0 if there is no axis.
  [[nodiscard]] uint64_t rows() const { return shape.empty() ? 0 : shape[0]; }
  [[nodiscard]] uint64_t row_elements() const;
  /// Size of a row of numbers in memory, in bytes. It does not overflow: arrays of opened files are
  /// checked.
  [[nodiscard]] uint64_t row_bytes() const { return row_elements() * size_bytes(element.type); }

  friend bool operator==(const ArrayInfo&, const ArrayInfo&) = default;
};

/// The value of an attribute.
struct Attribute {
  Element element;
  std::vector<uint64_t> shape;   ///< Empty: one element.
  std::vector<std::byte> bytes;  ///< The numbers.
  std::vector<std::string> texts;

  friend bool operator==(const Attribute&, const Attribute&) = default;
};

}  // namespace engram::h5
