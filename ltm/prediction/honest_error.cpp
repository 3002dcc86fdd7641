// SPDX-License-Identifier: Apache-2.0
#include "ltm/prediction/honest_error.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "ltm/core/not_a_number.h"

namespace engram::ltm {

namespace {

using Errors = std::vector<std::pair<size_t, MemberErrors>>;

/// A model's held-out mean squared error counts only if it is larger by this factor. Held-out
/// moments are few and not those of the past at hand: a model that only copies looked a third worse
/// than a copy, while one that had learned its past by heart was off by a factor of a thousand.
constexpr double kClearDifference = 2.25;

double mean_of(const std::vector<double>& values) {
  double sum = 0, count = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    sum += value;
    count += 1;
  }
  return count > 0 ? sum / count : kNaN;
}

template <typename Kind>
double mean_of(const Errors& errors, Kind kind) {
  std::vector<double> values;
  for (const auto& [row, error] : errors) values.push_back(error.pooled.*kind);
  return mean_of(values);
}

/// The record with the most steps up to `steps`, or the first one if all have more.
std::optional<MeasuredError> record_at(const Predictor& predictor, PredictorInputs given,
                                       int steps) {
  std::optional<MeasuredError> found;
  for (const HorizonRecord& record : predictor.records(given)) {
    if (record.predictions == 0 || (found && record.steps > steps)) continue;
    found = record.mean;
  }
  return found;
}

/// How errors of one kind are raised. The offset is for a model without any error on this past:
/// there is no error that a factor could raise.
struct Raise {
  double factor = 1;
  double offset = 0;

  [[nodiscard]] double of(double error) const { return error * factor + offset; }
};

template <typename Kind>
Raise raise_of(const Errors& errors, const MeasuredError& held_out,
               const std::optional<MeasuredError>& held_out_copy, const MeasuredError& copied,
               Kind kind) {
  const double measured = mean_of(errors, kind);
  double honest = held_out.*kind;
  if (held_out_copy && (*held_out_copy).*kind > 0 && copied.*kind > 0)
    honest = copied.*kind * (held_out.*kind / ((*held_out_copy).*kind));
  if (!(honest > kClearDifference * measured)) return {};
  return measured > 0 ? Raise{honest / measured, 0} : Raise{1, honest};
}

}  // namespace

MeasuredError copied_baseline(const InstanceHistory& history, const Errors& errors,
                              Duration ahead) {
  const NumberSeries& series = history.series();
  std::vector<double> images, numbers;
  for (const auto& [row, error] : errors) {
    const size_t then = row + series.steps_in(ahead);
    if (then >= series.rows()) continue;
    const auto others = history.copied_error(row, then);
    images.push_back(others ? others->pooled.image_mse : kNaN);
    numbers.push_back(joined_error(
        history.rows().mean_square(series.row(row), series.row(then)), history.rows().counted(),
        others ? others->pooled.number_mse : kNaN, history.samples().number_elements()));
  }
  return {mean_of(images), mean_of(numbers)};
}

void make_honest(const EngineChoiceInputs& inputs, const idf::Layout& layout, const Engine& model,
                 int steps, const MeasuredError& copied, Errors& errors) {
  const bool is_told = inputs.condition_at && model.predictor->condition();
  const PredictorInputs given = is_told ? PredictorInputs::kConditions : PredictorInputs::kValues;
  const auto held_out = record_at(*model.predictor, given, steps);
  if (!held_out) return;
  std::optional<MeasuredError> held_out_copy;
  for (const Engine& other : inputs.models)
    if (other.predictor->name() == kCopyLast)
      held_out_copy = record_at(*other.predictor, PredictorInputs::kValues, steps);
  const Raise images =
      raise_of(errors, *held_out, held_out_copy, copied, &MeasuredError::image_mse);
  const Raise numbers =
      raise_of(errors, *held_out, held_out_copy, copied, &MeasuredError::number_mse);
  for (auto& [row, error] : errors) {
    error.pooled.image_mse = images.of(error.pooled.image_mse);
    error.pooled.number_mse = numbers.of(error.pooled.number_mse);
    for (size_t i = 0; i < error.squares.size(); ++i) {
      const bool is_image = layout.members()[i].kind == idf::MemberKind::kImage;
      error.squares[i] = (is_image ? images : numbers).of(error.squares[i]);
    }
  }
}

}  // namespace engram::ltm
