// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "ltm/idf/ndarray.h"

namespace engram::ltm {

/// What is stored of a number instead of itself. The values are part of the format.
enum class ColumnTransform : uint8_t {
  kNone = 0,
  kDelta = 1,       ///< Its difference from the one before.
  kXor = 2,         ///< The bits that differ from the one before.
  kDeltaDelta = 3,  ///< The change of that difference.
};

/// How the bytes of what is stored lie. The values are part of the format.
enum class ColumnShuffle : uint8_t { kNone = 0, kBytes = 1, kBits = 2 };

/// What won for one column.
struct ColumnScheme {
  ColumnTransform transform = ColumnTransform::kNone;
  ColumnShuffle shuffle = ColumnShuffle::kNone;
  /// Floats that have so many decimal digits, all of them, are stored as integers; 255: as floats.
  uint8_t decimals = 255;

  friend bool operator==(const ColumnScheme&, const ColumnScheme&) = default;
};

/// "delta, bits", "delta of delta, bytes, 3 decimals".
[[nodiscard]] std::string to_string(const ColumnScheme& scheme);

/// Compresses a column of numbers without loss, in the way that makes it smallest: all are tried
/// on the column, on three parts of it where it is long. Equal columns give equal bytes.
/// `elements` hold whole elements (checked).
/// Complexity: about 12 times that of Zstandard at level 3 up to 64 KiB, once at level 9 beyond.
/// Source: docs/codecs.md, section "Columns".
[[nodiscard]] std::vector<std::byte> compress_column(idf::ElementType type,
                                                     std::span<const std::byte> elements);

/// The bytes of `count` elements. Safe on hostile bytes.
/// Errors: kDataLoss where the bytes hold anything else.
Result<std::vector<std::byte>> decompress_column(std::span<const std::byte> bytes,
                                                 idf::ElementType type, size_t count);

/// Errors: kDataLoss.
Result<ColumnScheme> column_scheme(std::span<const std::byte> bytes);

}  // namespace engram::ltm
