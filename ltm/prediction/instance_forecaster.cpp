// SPDX-License-Identifier: Apache-2.0
#include "ltm/prediction/instance_forecaster.h"

#include <algorithm>
#include <cmath>

#include "ltm/prediction/error_bound.h"

namespace engram::ltm {

namespace {

constexpr std::string_view kCopyLast = "copy-last";
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
/// Numbers of all rows together: with more there are fewer rows.
constexpr size_t kMostNumbersKept = size_t{1} << 22;

/// Mean and bound of one kind of error; NaN without any.
struct Spread {
  double mean = kNaN, bound = kNaN;
};

template <typename Kind>
Spread spread_of(std::span<const MeasuredError> errors, Kind kind) {
  std::vector<double> known;
  double sum = 0;
  for (const MeasuredError& error : errors) {
    if (!std::isfinite(error.*kind)) continue;
    known.push_back(error.*kind);
    sum += error.*kind;
  }
  if (known.empty()) return {};
  return {sum / static_cast<double>(known.size()), bound_of(known)};
}

/// Of two parts of one value, by how many elements they have.
double joined(double a, size_t a_count, double b, size_t b_count) {
  if (a_count == 0 || std::isnan(a)) return b;
  if (b_count == 0 || std::isnan(b)) return a;
  const auto left = static_cast<double>(a_count), right = static_cast<double>(b_count);
  return (a * left + b * right) / (left + right);
}

double finite_or_nan(double number) {
  return std::isfinite(number) ? number : kNaN;
}

MeasuredError known_or(const MeasuredError& known, const MeasuredError& other) {
  return {std::isnan(known.image_mse) ? other.image_mse : known.image_mse,
          std::isnan(known.number_mse) ? other.number_mse : known.number_mse};
}

int model_steps(const Predictor& predictor, Duration ahead) {
  if (predictor.step() <= Duration(0)) return 1;
  return static_cast<int>(
      std::clamp(std::round(to_seconds(ahead) / to_seconds(predictor.step())), 1.0, 1e9));
}

}  // namespace

InstanceForecaster::InstanceForecaster(const EngineChoiceInputs& inputs) : inputs_(inputs) {}

bool InstanceForecaster::has_models() const {
  return std::ranges::any_of(
      inputs_.models, [](const Engine& engine) { return engine.predictor->name() != kCopyLast; });
}

InstanceForecaster::Window InstanceForecaster::window_of(const ValueRow& rows) const {
  const bool has_images = !rows.other_members().empty();
  if (has_models()) return has_images ? kOfImageModels : kOfModels;
  if (has_images) return kOfImages;
  const size_t most = kMostNumbersKept / std::max<size_t>(rows.numbers(), 1);
  return {std::min(kOfNumbers.rows, most), kOfNumbers.predictions};
}

size_t InstanceForecaster::values_wanted(const idf::Data& value) const {
  const ValueRow rows(value, inputs_.type ? &*inputs_.type : nullptr);
  const size_t window = window_of(rows).rows;
  // Numbers are learned from more than they are measured on; images are dear to read.
  return rows.other_members().empty() ? std::max(window, kOfNumbers.rows) : window;
}

void InstanceForecaster::start(const idf::Data& value) {
  rows_.emplace(value, inputs_.type ? &*inputs_.type : nullptr, has_rotations_);
  members_.emplace(*rows_);
  window_ = window_of(*rows_);
  const size_t most = kMostNumbersKept / std::max<size_t>(rows_->numbers(), 1);
  series_ = std::make_unique<NumberSeries>(rows_->numbers(), std::min(kOfNumbers.rows, most));
  forecaster_ = std::make_unique<SeriesForecaster>(
      *series_, *rows_, SeriesForecaster::Options{window_.rows, window_.predictions, has_models()});
  samples_.clear();
  values_.clear();
  model_errors_.clear();
}

void InstanceForecaster::add(Time time, const idf::Data& value) {
  auto split = rows_ ? rows_->layout().split(value) : Result<idf::SplitValue>(not_found("none"));
  if (!split.ok()) {
    has_rotations_ = true;
    start(value);
    split = rows_->layout().split(value);
  }
  const auto before = [this] {
    return series_->rows() == 0 ? std::span<const double>() : series_->row(series_->rows() - 1);
  };
  std::vector<double> row(rows_->numbers());
  if (!rows_->read(*split, before(), row)) {
    has_rotations_ = false;
    start(value);
    split = rows_->layout().split(value);
    row.resize(rows_->numbers());
    const bool is_read = rows_->read(*split, {}, row);
    ENGRAM_CHECK(is_read, "a value without rotations");
  }
  const Status added = series_->add(time, row);
  ENGRAM_CHECK(added.ok(), "{}", added.message());
  if (!rows_->other_members().empty()) samples_.push_back(members_->sample(*split));
  values_.push_back(value);
  while (samples_.size() > window_.rows) samples_.pop_front();
  while (values_.size() > (has_models() ? window_.rows : 1)) values_.pop_front();
  const uint64_t first = series_->added() - values_.size();
  while (!model_errors_.empty() && model_errors_.begin()->first.first < first)
    model_errors_.erase(model_errors_.begin());
  last_ = std::move(*split);
}

/// Of copies so many steps ahead: of what only is copied, on the rows that engines are measured on.
std::vector<MeasuredError> InstanceForecaster::copied_errors(size_t steps) const {
  std::vector<MeasuredError> errors;
  if (samples_.empty()) return errors;
  const size_t first = series_->rows() - samples_.size();
  for (const size_t row : forecaster_->test_rows(steps))
    if (row >= first)
      errors.push_back(members_->difference(samples_[row + steps - first], samples_[row - first]));
  return errors;
}

std::vector<EngineRecord> InstanceForecaster::series_records(Duration ahead) {
  const std::vector<MeasuredError> copied = copied_errors(series_->steps_in(ahead));
  const Spread images = spread_of(copied, &MeasuredError::image_mse);
  const Spread numbers = spread_of(copied, &MeasuredError::number_mse);
  const size_t copied_numbers = members_->number_elements();
  if (rows_->elements() == 0)
    return {{std::string(kCopyLast),
             "",
             copied.size(),
             {images.mean, numbers.mean},
             {images.bound, numbers.bound}}};
  std::vector<EngineRecord> records;
  for (const SeriesRecord& one : forecaster_->records(ahead)) {
    if (!rows_->has_continued() && one.engine != kCopyLast) continue;
    EngineRecord& record = records.emplace_back(EngineRecord{one.engine, "", one.predictions});
    if (one.predictions == 0) continue;
    const auto square = [](double rmse) { return finite_or_nan(rmse * rmse); };
    record.mean = {images.mean,
                   joined(square(one.rmse), rows_->elements(), numbers.mean, copied_numbers)};
    record.bound = {images.bound, joined(square(one.bound_rmse), rows_->elements(), numbers.bound,
                                         copied_numbers)};
  }
  return records;
}

std::vector<std::string> InstanceForecaster::engines() const {
  std::vector<std::string> names;
  for (const Engine& model : inputs_.models)
    if (model.predictor->name() != kCopyLast) names.emplace_back(model.predictor->name());
  if (!rows_->has_continued()) {
    names.emplace_back(kCopyLast);
    return names;
  }
  for (const auto& engine : make_series_engines()) names.emplace_back(engine->name());
  return names;
}

Result<std::vector<EngineRecord>> InstanceForecaster::records(Duration ahead,
                                                              const std::string& only) {
  std::vector<EngineRecord> records;
  for (const Engine& model : inputs_.models) {
    const std::string_view name = model.predictor->name();
    if (name == kCopyLast || (!only.empty() && name != only)) continue;
    ENGRAM_ASSIGN_OR_RETURN(records.emplace_back(), model_record(model, ahead));
    if (name == only) return records;
  }
  for (EngineRecord& record : series_records(ahead))
    if (only.empty() || record.engine == only) records.push_back(std::move(record));
  return records;
}

Result<EngineRecord> InstanceForecaster::model_record(const Engine& model, Duration ahead) {
  std::vector<MeasuredError> errors;
  for (const size_t row : forecaster_->test_rows(series_->steps_in(ahead))) {
    if (row < row_of_value(0)) continue;
    const auto error = model_error(model, row, model_steps(*model.predictor, ahead));
    // Values of another layout than the model's: nothing can be told of it.
    if (error.status().code() == StatusCode::kInvalidArgument) break;
    ENGRAM_RETURN_IF_ERROR(error.status());
    errors.push_back(*error);
  }
  const Spread images = spread_of(errors, &MeasuredError::image_mse);
  const Spread numbers = spread_of(errors, &MeasuredError::number_mse);
  return EngineRecord{std::string(model.predictor->name()),
                      model.model,
                      errors.size(),
                      {images.mean, numbers.mean},
                      {images.bound, numbers.bound}};
}

/// Predicted once for all horizons up to the longest that was asked for.
Result<MeasuredError> InstanceForecaster::model_error(const Engine& model, size_t row, int steps) {
  const uint64_t forgotten = series_->added() - series_->rows();
  const auto wanted = static_cast<size_t>(steps);
  auto& known = model_errors_[{forgotten + row, std::string(model.predictor->name())}];
  if (known.size() >= wanted) return known[wanted - 1];
  known.clear();
  ENGRAM_ASSIGN_OR_RETURN(const auto predicted, predict_from(model, row - row_of_value(0), steps));
  std::vector<MeasuredError> errors;
  for (size_t i = 0; i < wanted; ++i) {
    const size_t then =
        row + series_->steps_in(model.predictor->step() * static_cast<int64_t>(i + 1));
    MeasuredError& error = errors.emplace_back();
    if (then >= series_->rows() || series_->run_start(then) > row) continue;
    ENGRAM_ASSIGN_OR_RETURN(error, error_of(predicted[i].value, row, then));
  }
  known = std::move(errors);
  return known.back();
}

Result<std::vector<Prediction>> InstanceForecaster::predict_from(const Engine& model, size_t value,
                                                                 int steps) const {
  const size_t count = std::min(std::max<size_t>(model.predictor->context(), 1), value + 1);
  std::vector<idf::Data> values, conditions;
  const auto condition = model.predictor->condition();
  for (size_t i = value + 1 - count; i <= value; ++i) {
    values.push_back(values_[i]);
    if (!condition || !inputs_.condition_at) continue;
    ENGRAM_ASSIGN_OR_RETURN(auto known,
                            inputs_.condition_at(*condition, series_->time(row_of_value(i))));
    if (known) conditions.push_back(std::move(*known));
  }
  if (conditions.size() != values.size()) conditions.clear();
  auto predicted = model.predictor->predict(Past(values, conditions), steps);
  if (!predicted.ok())
    return predicted.status().with_context("prediction of " + inputs_.entity.to_string());
  if (predicted->size() < static_cast<size_t>(steps))
    return data_loss("model {}: predicted {} steps, needs {}", model.model, predicted->size(),
                     steps);
  predicted->resize(static_cast<size_t>(steps));
  return predicted;
}

Result<MeasuredError> InstanceForecaster::error_of(const idf::Data& predicted, size_t from,
                                                   size_t to) const {
  ENGRAM_ASSIGN_OR_RETURN(const auto split, rows_->layout().split(predicted));
  std::vector<double> row(rows_->numbers());
  if (!rows_->read(split, series_->row(from), row))
    return invalid_argument("found a rotation that is none");
  const double numbers = finite_or_nan(rows_->mean_square(row, series_->row(to)));
  if (samples_.empty()) return MeasuredError{kNaN, numbers};
  const MeasuredError others = members_->difference(
      samples_[to - (series_->rows() - samples_.size())], members_->sample(split));
  return MeasuredError{others.image_mse, joined(numbers, rows_->elements(), others.number_mse,
                                                members_->number_elements())};
}

Result<Prediction> InstanceForecaster::predict(Duration ahead, const EngineRecord& engine) {
  const auto model = std::ranges::find(inputs_.models, engine.engine, [](const Engine& one) {
    return std::string(one.predictor->name());
  });
  Prediction prediction{values_.back(), {}};
  if (model != inputs_.models.end()) {
    ENGRAM_ASSIGN_OR_RETURN(
        const auto predicted,
        predict_from(*model, values_.size() - 1, model_steps(*model->predictor, ahead)));
    prediction = predicted.back();
  } else if (engine.engine != kCopyLast) {
    ENGRAM_ASSIGN_OR_RETURN(const auto continued, forecaster_->predict(ahead, engine.engine));
    prediction.value = rows_->value(*last_, series_->row(series_->rows() - 1), continued.values);
  }
  prediction.error.expected = known_or(prediction.error.expected, engine.mean);
  prediction.error.bound = known_or(prediction.error.bound, engine.bound);
  return prediction;
}

}  // namespace engram::ltm
