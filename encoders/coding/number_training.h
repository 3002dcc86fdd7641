// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "encoders/coding/number_model.h"

namespace engram::encoders {

struct NumberTraining {
  /// Rows of the blocks that will be coded; 0: whole recordings. Tells where blocks start.
  size_t block_rows = 0;
  /// Numbers that may help to predict one: each costs four bytes of the model.
  size_t max_terms = 8;
  /// A term must save so many bits of the training data: more keeps the model small and less bound
  /// to what it saw.
  double min_gain_bits = 6;
  /// Rows that are looked at, those of all recordings together. Time grows with them and with the
  /// square of the numbers.
  size_t max_rows = 4096;

  [[nodiscard]] Status validate() const;
};

/// Learns an entity's predictors and starts from recordings of it.
///
/// Shape: each recording [rows, N], N the numbers of the fields; what is not finite is passed over.
/// Errors: kInvalidArgument where fields, options or a recording's size do not fit.
/// Threading: const-parallel. The same input gives the same model on one machine, not on all: what
/// it decodes to is part of the model, and that is the same everywhere.
Result<NumberModel> train_number_model(std::vector<NumberField> fields,
                                       std::span<const std::vector<double>> recordings,
                                       const NumberTraining& options);

}  // namespace engram::encoders
