// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "encoders/coding/number_model.h"

namespace engram::encoders {

/// Turns rows of numbers into few bytes, every one within its bound, and back.
///
/// A block decodes alone; K rows of it cost less than K blocks, and reaching one row of it means
/// decoding those before. Bounded numbers lie on a lattice around their prediction; what that
/// cannot hold (infinities, huge values, quaternions of other lengths) is kept bit by bit.
/// What is decoded is the same on every machine.
/// Shape: rows [K, N], N = model().count().
/// Threading: const-parallel.
/// Source: docs/learning_methods.md, section "Numbers".
class NumberCodec {
 public:
  explicit NumberCodec(NumberModel model) : model_(std::move(model)) {}

  /// Needs whole rows (checked). Equal rows give equal bytes.
  [[nodiscard]] std::vector<std::byte> encode(std::span<const double> rows) const;

  /// The rows of a block of exactly `count`. Safe on hostile bytes.
  /// Errors: kDataLoss where the checksum does not fit or the block has another number of rows.
  Result<std::vector<double>> decode(std::span<const std::byte> block, size_t count) const;

  [[nodiscard]] const NumberModel& model() const { return model_; }

 private:
  NumberModel model_;
};

}  // namespace engram::encoders
