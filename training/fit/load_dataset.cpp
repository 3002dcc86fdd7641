// SPDX-License-Identifier: Apache-2.0
#include "training/fit/load_dataset.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "training/fit/augmented_rows.h"
#include "training/fit/scenes.h"
#include "training/fit/thinning.h"

namespace engram::training {

using torch::Tensor;

namespace {

/// Bytes of one value in memory.
uint64_t value_bytes(const encoders::TensorPlan& plan) {
  uint64_t bytes = plan.number_count() * sizeof(double);
  for (const auto& image : plan.images())
    bytes += static_cast<uint64_t>(image.height) * static_cast<uint64_t>(image.width) *
             static_cast<uint64_t>(image.channels) * (image.is_depth ? 2 : 1);
  return bytes;
}

size_t total_size(std::span<const SnapshotRun> runs) {
  size_t total = 0;
  for (const SnapshotRun& run : runs) total += run.rows.size();
  return total;
}

/// Mean and deviation for normalising a number.
struct Scale {
  double mean = 0;
  double deviation = 0;

  /// Whether numbers of another scale have a normal size in this one.
  [[nodiscard]] bool holds(const Scale& other) const {
    constexpr double kMax = 4;
    return deviation > 0 && other.deviation <= kMax * deviation &&
           std::abs(other.mean - mean) <= kMax * deviation;
  }
};

/// The scale of one column. A number that never changes has deviation 0 and its exact value as
/// mean.
Scale scale_of(const Tensor& column) {
  const Tensor known = column.masked_select(torch::isfinite(column));
  if (known.numel() == 0) return {};
  const double first = known[0].item<double>();
  if (known.min().equal(known.max())) return {first, 0};
  const double mean = known.mean().item<double>();
  const double spread = (known - mean).square().mean().sqrt().item<double>();
  if (!(spread > 0) || !std::isfinite(spread)) return {mean, 0};
  return {mean, spread};
}

/// Chooses means and deviations. Given ones are kept if the columns have a normal size in them,
/// else they are replaced by those of the columns. Shape: plain [n, N] of float64.
void choose_scales(const Tensor& plain, std::vector<double>& mean, std::vector<double>& deviation) {
  const auto count = static_cast<size_t>(plain.size(1));
  mean.resize(count);
  deviation.resize(count);
  for (size_t i = 0; i < count; ++i) {
    const Scale found = scale_of(plain.select(1, static_cast<int64_t>(i)));
    const Scale known{mean[i], deviation[i]};
    const Scale scale = known.holds(found) ? known : found;
    mean[i] = scale.mean;
    deviation[i] = scale.deviation;
  }
}

DatasetRows empty_rows(const encoders::TensorPlan& plan, int64_t rows) {
  DatasetRows empty;
  for (const auto& image : plan.images())
    empty.images.push_back(torch::empty({rows, image.height, image.width, image.channels},
                                        image.is_depth ? torch::kInt16 : torch::kUInt8));
  empty.plain_numbers =
      torch::empty({rows, static_cast<int64_t>(plan.number_count())}, torch::kFloat64);
  return empty;
}

/// Reads a value of the source into a row.
Status read_row(const TrainingSource& source, size_t index, const encoders::TensorPlan& plan,
                int64_t row, DatasetRows& rows) {
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data value, source.read(index));
  ENGRAM_ASSIGN_OR_RETURN(const auto split, plan.layout().split(value));
  for (size_t i = 0; i < rows.images.size(); ++i) {
    const auto bytes = split.tensors[plan.images()[i].member].bytes();
    std::memcpy(rows.images[i].select(0, row).data_ptr(), bytes.data(), bytes.size());
  }
  const std::vector<double> numbers = plan.read_numbers(split);
  std::copy(numbers.begin(), numbers.end(), rows.plain_numbers.select(0, row).data_ptr<double>());
  rows.times.push_back(source.times[index]);
  return {};
}

/// The numbers of a condition; none if it has another layout.
std::vector<double> condition_numbers(const encoders::Condition& condition,
                                      const idf::Data& value) {
  const auto split = condition.plan.layout().split(value);
  return split.ok() ? condition.plan.read_numbers(*split) : std::vector<double>();
}

/// Rows of which those without numbers are NaN. Shape: [n, count].
Tensor conditions_tensor(const std::vector<std::vector<double>>& rows, size_t count) {
  Tensor plain = torch::full({static_cast<int64_t>(rows.size()), static_cast<int64_t>(count)},
                             std::numeric_limits<double>::quiet_NaN(), torch::kFloat64);
  for (size_t row = 0; row < rows.size(); ++row)
    std::ranges::copy(rows[row], plain.select(0, static_cast<int64_t>(row)).data_ptr<double>());
  return plain;
}

class Loader {
 public:
  Loader(const TrainingSource& source, bool has_networks, const encoders::DeepModel* start,
         const std::stop_token& stop)
      : source_(source), has_networks_(has_networks), start_(start), stop_(stop) {}

  Result<Dataset> load(std::vector<Sequence> sequences, uint64_t memory_bytes) {
    ENGRAM_ASSIGN_OR_RETURN(const idf::Data first, source_.read(sequences.front().first));
    ENGRAM_ASSIGN_OR_RETURN(
        data_.plan, encoders::TensorPlan::create(source_.layout.value_or(idf::Layout::of(first))));
    ThinnedRuns thin =
        thinned(sequences, memory_bytes / std::max<uint64_t>(value_bytes(data_.plan), 1));
    const std::vector<SnapshotRun>& runs = thin.read;
    data_.left_out_runs = std::move(thin.left_out);
    DatasetRows rows = empty_rows(data_.plan, static_cast<int64_t>(total_size(runs)));
    for (const SnapshotRun& run : runs) ENGRAM_RETURN_IF_ERROR(read(run, rows));
    data_.times = std::move(rows.times);
    data_.images = std::move(rows.images);
    data_.plain_numbers = std::move(rows.plain_numbers);
    ENGRAM_RETURN_IF_ERROR(read_conditions(runs));
    choose_depth_scales();
    normalise();
    data_.scene = torch::zeros({static_cast<int64_t>(data_.size())}, torch::kLong);
    // Backgrounds are for networks alone, and coding them takes seconds where images are large.
    if (has_networks_ && !data_.images.empty())
      ENGRAM_RETURN_IF_ERROR(find_scenes(data_, start_, stop_));
    if (start_ != nullptr) data_.error_price = start_->provenance.error_price;
    return std::move(data_);
  }

 private:
  Status read(const SnapshotRun& run, DatasetRows& rows) {
    const auto& [source_rows, first_held_out] = run;
    const size_t row = rows.times.size();
    for (size_t i = 0; i < source_rows.size(); ++i) {
      if (stop_.stop_requested()) return cancelled("training of {} was stopped", source_.entity);
      const size_t index = source_rows.first + i;
      ENGRAM_RETURN_IF_ERROR(
          read_row(source_, index, data_.plan, static_cast<int64_t>(row + i), rows));
      data_.is_known.push_back(start_ != nullptr && !source_.is_known.empty() &&
                               source_.is_known[index]);
    }
    data_.sequences.push_back({row, row + source_rows.size()});
    data_.first_held_out.push_back(row + (first_held_out - source_rows.first));
    data_.source_rows.push_back(source_rows);
    return {};
  }

  /// Reads all conditions, if any has numbers. Values with another layout than the first one count
  /// as unknown and become the mean.
  Status read_conditions(std::span<const SnapshotRun> runs) {
    if (!source_.read_condition || data_.images.empty()) return {};
    encoders::Condition condition;
    condition.entity = source_.condition_entity;
    std::vector<std::vector<double>> rows;
    for (const SnapshotRun& run : runs)
      for (size_t index = run.rows.first; index < run.rows.end; ++index) {
        if (stop_.stop_requested()) return cancelled("training of {} was stopped", source_.entity);
        ENGRAM_ASSIGN_OR_RETURN(const auto value, source_.read_condition(index));
        auto& row = rows.emplace_back();
        if (!value) continue;
        if (condition.plan.number_count() == 0) {
          auto plan = encoders::TensorPlan::create(idf::Layout::of(*value));
          if (!plan.ok() || plan->number_count() == 0) return {};
          condition.plan = *std::move(plan);
        }
        row = condition_numbers(condition, *value);
      }
    const size_t count = condition.plan.number_count();
    if (count == 0) return {};
    const Tensor plain = conditions_tensor(rows, count);
    if (start_ != nullptr && start_->condition &&
        start_->condition->plan.layout() == condition.plan.layout()) {
      condition.mean = start_->condition->mean;
      condition.deviation = start_->condition->deviation;
    }
    choose_scales(plain, condition.mean, condition.deviation);
    data_.conditions = normalised(plain, condition.mean, condition.deviation);
    data_.condition = std::move(condition);
    return {};
  }

  void choose_depth_scales() {
    for (size_t i = 0; i < data_.images.size(); ++i) {
      auto& image = data_.plan.images()[i];
      if (!image.is_depth) continue;
      const Tensor pixels = data_.images[i];
      const auto* values = static_cast<const uint16_t*>(pixels.data_ptr());
      const uint16_t largest = *std::max_element(values, values + pixels.numel());
      image.scale = 255.0 / std::max<uint16_t>(largest, 1);
      // The range of the previous model is kept if it is the larger one.
      if (start_ != nullptr) image.scale = std::min(image.scale, start_->plan.images()[i].scale);
    }
  }

  void normalise() {
    if (start_ != nullptr) {
      data_.mean = start_->mean;
      data_.deviation = start_->deviation;
    }
    choose_scales(data_.plain_numbers, data_.mean, data_.deviation);
    if (!data_.mean.empty())
      data_.numbers = normalised(data_.plain_numbers, data_.mean, data_.deviation);
  }

  const TrainingSource& source_;
  bool has_networks_;
  const encoders::DeepModel* start_;
  const std::stop_token& stop_;
  Dataset data_;
};

}  // namespace

Result<Dataset> load_dataset(const TrainingSource& source, const TrainOptions& options,
                             const encoders::DeepModel* start, const std::stop_token& stop) {
  std::vector<Sequence> sequences = cut_sequences(source.times);
  const auto left_out = static_cast<size_t>(options.hold_out_recordings);
  if (left_out >= sequences.size())
    return invalid_argument("{}: found {} recordings, needs more than the {} to leave out",
                            source.entity, sequences.size(), left_out);
  sequences.resize(sequences.size() - left_out);
  ENGRAM_ASSIGN_OR_RETURN(Dataset data, Loader(source, options.has_networks, start, stop)
                                            .load(std::move(sequences), options.memory_bytes));
  data.left_out_sequences = left_out;
  if (!source.augmented || options.augmented_share <= 0 || data.images.empty()) return data;
  ENGRAM_ASSIGN_OR_RETURN(AugmentedRows rows,
                          read_augmented(source, data, options.memory_bytes, stop));
  if (rows.size() > 0) data.augmented = std::move(rows);
  return data;
}

Result<DatasetRows> read_rows(const TrainingSource& source, const Dataset& data,
                              const Sequence& run) {
  DatasetRows rows = empty_rows(data.plan, static_cast<int64_t>(run.size()));
  std::vector<std::vector<double>> conditions;
  for (size_t i = 0; i < run.size(); ++i) {
    const size_t index = run.first + i;
    ENGRAM_RETURN_IF_ERROR(read_row(source, index, data.plan, static_cast<int64_t>(i), rows));
    if (!data.condition) continue;
    ENGRAM_ASSIGN_OR_RETURN(const auto value, source.read_condition(index));
    conditions.push_back(value ? condition_numbers(*data.condition, *value)
                               : std::vector<double>());
  }
  if (data.condition)
    rows.plain_conditions = conditions_tensor(conditions, data.condition->plan.number_count());
  return rows;
}

}  // namespace engram::training
