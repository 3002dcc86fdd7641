// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "encoders/coding/number_model.h"

namespace engram::encoders {

struct NumberTraining {
  /// Rows of the blocks that will be coded, which gives where blocks start; 0 for whole recordings.
  size_t block_rows = 0;
  /// Max number of terms that predict one number. Each costs four bytes of the model, and 16 of
  /// them without a min gain overfitted in measurements.
  size_t max_terms = 8;
  /// Min number of bits that a term must save in the training data. Larger values keep the model
  /// smaller and reduce overfitting. Of 24, 12, 6 and 2 bits, 6 was the best on left-out
  /// recordings.
  double min_gain_bits = 6;
  /// Max number of rows of all recordings that are used. Time grows with them and with the square
  /// of the number of numbers.
  size_t max_rows = 4096;

  [[nodiscard]] Status validate() const;
};

/// Learns the predictors and starts of an entity from its recordings.
///
/// Shape: each recording [rows, N], where N is the number of numbers of all fields. Values that are
/// not finite are skipped.
/// Errors: kInvalidArgument if fields, options or the size of a recording are invalid.
/// Threading: const-parallel. The same input gives the same model on one machine, but not on all. A
/// given model decodes to the same values everywhere.
Result<NumberModel> train_number_model(std::vector<NumberField> fields,
                                       std::span<const std::vector<double>> recordings,
                                       const NumberTraining& options);

}  // namespace engram::encoders
