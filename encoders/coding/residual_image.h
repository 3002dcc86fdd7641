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
#include "ltm/idf/ndarray.h"

namespace engram::encoders {

class ResidualCoder;

/// Codes the residuals of consecutive images, one row at a time: the smallest ones that keep each
/// image within an error bound. A row may have no residual. A residual may continue from the last
/// one.
///
/// It uses integer arithmetic only, so every machine decodes the same residuals.
/// Threading: one thread.
/// Source: docs/learning_methods.md, section "Residuals".
class ResidualEncoder {
 public:
  explicit ResidualEncoder(const PixelShape& shape);
  ~ResidualEncoder();

  /// Adds the next row. If the squared differences between `decoded` and `recorded` sum to at most
  /// `max_error`, the row has no residual; else it gets the coarsest one that reaches this. If none
  /// does, the function returns false and adds no row.
  /// Shape: both [H, W, C].
  [[nodiscard]] bool add(std::span<const uint8_t> decoded, std::span<const uint8_t> recorded,
                         uint64_t max_error);

  /// Returns the code of all rows, which is empty if none has a residual.
  /// Format: per row a varint, which is 0 if it has no residual and else one more than the size of
  /// its code in bytes; then the codes.
  [[nodiscard]] std::vector<std::byte> finish() const;

 private:
  PixelShape shape_;
  BlockGrid grid_;
  std::unique_ptr<ResidualCoder> coder_;
  /// Per row; empty if it has no residual.
  std::vector<std::optional<std::vector<std::byte>>> codes_;
};

/// Residuals of rows as coefficients (block_transform.h); empty for a row without a residual.
using ResidualRows = std::vector<std::vector<int16_t>>;

/// Decodes the first `wanted` of `rows` rows. It is safe on hostile bytes: any code decodes to some
/// residual.
/// Errors: kDataLoss if the bytes hold fewer rows.
Result<ResidualRows> decode_residuals(std::span<const std::byte> bytes, const PixelShape& shape,
                                      size_t rows, size_t wanted);

/// The size in bytes of each of `rows` rows, if it has a residual.
/// Errors: as for decode_residuals.
Result<std::vector<std::optional<uint64_t>>> residual_bytes(std::span<const std::byte> bytes,
                                                            size_t rows);

/// Adds a residual to `image`, rounded and clamped.
/// Shape: [H, W, C].
void add_residual(std::span<const int16_t> residual, const PixelShape& shape,
                  std::span<uint8_t> image);

/// The image with a residual added.
/// Shape: uint8 [H, W, C].
[[nodiscard]] idf::NdArray with_residual(const idf::NdArray& image,
                                         std::span<const int16_t> residual,
                                         const PixelShape& shape);

}  // namespace engram::encoders
