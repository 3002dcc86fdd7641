// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "encoders/coding/block_transform.h"
#include "ltm/core/status.h"

namespace engram::encoders {

class ResidualCoder;

/// Codes what consecutive images lack, row by row of a block: as little as keeps each within a
/// bound. Rows may have none; one that has may go on from what the last one lacked.
///
/// Integer arithmetic only: every machine adds the same to what it decoded.
/// Threading: one thread.
/// Source: docs/learning_methods.md, section "Residuals".
class ResidualEncoder {
 public:
  explicit ResidualEncoder(const PixelShape& shape);
  ~ResidualEncoder();

  /// The next row. Where the squares of all differences between `decoded` and `recorded` sum to at
  /// most `max_error` it needs no residual; else it gets the coarsest one that makes them so.
  /// Returns false where none does: then no row is added.
  /// Shape: both [H, W, C].
  [[nodiscard]] bool add(std::span<const uint8_t> decoded, std::span<const uint8_t> recorded,
                         uint64_t max_error);

  /// All rows as they are stored; empty where none has a residual.
  /// Format: per row a varint: 0 where it has none, else one more than the bytes of its code; then
  /// the codes.
  [[nodiscard]] std::vector<std::byte> finish() const;

 private:
  PixelShape shape_;
  BlockGrid grid_;
  std::unique_ptr<ResidualCoder> coder_;
  std::vector<std::optional<std::vector<std::byte>>> codes_;  ///< Per row; nothing: it has none.
};

/// What rows lack, as coefficients (block_transform.h); empty where a row lacks nothing.
using ResidualRows = std::vector<std::vector<int16_t>>;

/// The first `wanted` of `rows` rows. Safe on hostile bytes: any code gives some residual.
/// Errors: kDataLoss where the bytes do not hold so many rows.
Result<ResidualRows> decode_residuals(std::span<const std::byte> bytes, const PixelShape& shape,
                                      size_t rows, size_t wanted);

/// The bytes that each of `rows` rows takes; nothing where it has no residual.
/// Errors: as decode_residuals.
Result<std::vector<std::optional<uint64_t>>> residual_bytes(std::span<const std::byte> bytes,
                                                            size_t rows);

/// Adds what `image` lacks. Shape: [H, W, C].
void add_residual(std::span<const int16_t> residual, const PixelShape& shape,
                  std::span<uint8_t> image);

}  // namespace engram::encoders
