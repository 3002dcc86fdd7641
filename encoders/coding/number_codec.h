// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "encoders/coding/number_model.h"

namespace engram::encoders {

/// Encodes rows of numbers, each within its error bound, and decodes them.
///
/// A block decodes alone. One block of K rows is smaller than K blocks, but to read a row, the rows
/// before it must be decoded. Bounded numbers lie on a lattice around their prediction. Values that
/// it cannot hold (infinities, huge values, quaternions of other lengths) are kept bit by bit.
/// Decoded values are the same on every machine.
/// Shape: rows [K, N], N = model().count().
/// Threading: const-parallel.
/// Source: docs/learning_methods.md, section "Numbers".
class NumberCodec {
 public:
  explicit NumberCodec(NumberModel model) : model_(std::move(model)) {}

  /// Encodes whole rows (checked). Equal rows give equal bytes.
  [[nodiscard]] std::vector<std::byte> encode(std::span<const double> rows) const;

  /// Decodes a block of exactly `count` rows. It is safe on hostile bytes.
  /// Errors: kDataLoss if the checksum does not fit or the block has another number of rows.
  Result<std::vector<double>> decode(std::span<const std::byte> block, size_t count) const;

  [[nodiscard]] const NumberModel& model() const { return model_; }

 private:
  NumberModel model_;
};

}  // namespace engram::encoders
