// SPDX-License-Identifier: Apache-2.0
#include "memory/replay/prediction_error.h"

#include "ltm/prediction/instance_history.h"
#include "ltm/prediction/member_samples.h"
#include "ltm/prediction/value_row.h"

namespace engram::memory {

Result<ltm::MeasuredError> prediction_error(const idf::Data& predicted, const idf::Data& came,
                                            const std::optional<idf::Type>& type) {
  const idf::Type* const known = type ? &*type : nullptr;
  auto rows = std::make_unique<ltm::ValueRow>(came, known);
  ENGRAM_ASSIGN_OR_RETURN(const idf::SplitValue is, rows->layout().split(came));
  auto split = rows->layout().split(predicted);
  if (!split.ok()) return invalid_argument("what came has another layout than what was predicted");
  std::vector<double> came_row(rows->numbers()), predicted_row(rows->numbers());
  if (!rows->read(is, {}, came_row) || !rows->read(*split, came_row, predicted_row)) {
    // What is a rotation in one of them is none in the other: they are plain numbers.
    rows = std::make_unique<ltm::ValueRow>(came, known, false);
    came_row.assign(rows->numbers(), 0);
    predicted_row.assign(rows->numbers(), 0);
    ENGRAM_ASSIGN_OR_RETURN(const idf::SplitValue plain, rows->layout().split(came));
    const bool is_read = rows->read(plain, {}, came_row) && rows->read(*split, {}, predicted_row);
    ENGRAM_CHECK(is_read, "a value without rotations");
  }
  const ltm::MemberSamples samples(*rows);
  ltm::MeasuredError error = samples.difference(samples.sample(is), samples.sample(*split));
  error.number_mse = ltm::joined_error(rows->mean_square(came_row, predicted_row), rows->counted(),
                                       error.number_mse, samples.number_elements());
  return error;
}

}  // namespace engram::memory
