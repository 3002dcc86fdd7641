// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "ltm/idf/ndarray.h"

namespace engram::ltm {

/// The transform of a column's numbers before compression. The values are part of the format.
enum class ColumnTransform : uint8_t {
  kNone = 0,
  kDelta = 1,       ///< The difference from the previous number.
  kXor = 2,         ///< The bits that differ from the previous number.
  kDeltaDelta = 3,  ///< The change of the difference.
};

/// The shuffle of the transformed numbers. The values are part of the format.
enum class ColumnShuffle : uint8_t { kNone = 0, kBytes = 1, kBits = 2 };

/// The scheme that made one column smallest.
struct ColumnScheme {
  ColumnTransform transform = ColumnTransform::kNone;
  ColumnShuffle shuffle = ColumnShuffle::kNone;
  /// Number of decimal digits if all floats are stored as integers with that many decimals; 255 if
  /// they are stored as floats.
  uint8_t decimals = 255;

  friend bool operator==(const ColumnScheme&, const ColumnScheme&) = default;
};

/// "delta, bits", "delta of delta, bytes, 3 decimals".
[[nodiscard]] std::string to_string(const ColumnScheme& scheme);

/// Compresses a column of numbers without loss. All schemes are tried and the smallest wins; a long
/// column is tried on three parts of it. Equal columns give equal bytes. `elements` must contain
/// whole elements (checked).
/// Complexity: about 12 times that of Zstandard at level 3 up to 64 KiB, once at level 9 beyond.
/// Source: docs/codecs.md, section "Columns".
[[nodiscard]] std::vector<std::byte> compress_column(idf::ElementType type,
                                                     std::span<const std::byte> elements);

/// Decompresses a column of `count` elements and returns their bytes. Safe on hostile bytes.
/// Errors: kDataLoss if the bytes contain anything else.
Result<std::vector<std::byte>> decompress_column(std::span<const std::byte> bytes,
                                                 idf::ElementType type, size_t count);

/// The scheme of a compressed column. Errors: kDataLoss.
Result<ColumnScheme> column_scheme(std::span<const std::byte> bytes);

}  // namespace engram::ltm
