// SPDX-License-Identifier: Apache-2.0
#include "ltm/prediction/instance_history.h"

#include <algorithm>
#include <cmath>

#include "ltm/core/not_a_number.h"

namespace engram::ltm {

namespace {

/// Max numbers in all rows together. It bounds the memory: longer rows make fewer of them.
constexpr size_t kMaxNumbersKept = size_t{1} << 22;

}  // namespace

double joined_error(double a, size_t a_count, double b, size_t b_count) {
  if (a_count == 0 || std::isnan(a)) return b;
  if (b_count == 0 || std::isnan(b)) return a;
  const auto left = static_cast<double>(a_count), right = static_cast<double>(b_count);
  return (a * left + b * right) / (left + right);
}

bool InstanceHistory::has_models() const {
  return std::ranges::any_of(
      inputs_.models, [](const Engine& engine) { return engine.predictor->name() != kCopyLast; });
}

InstanceHistory::Window InstanceHistory::window_of(const ValueRow& rows) const {
  const bool has_images = !rows.other_members().empty();
  if (has_models()) return has_images ? kOfImageModels : kOfModels;
  if (has_images) return kOfImages;
  const size_t max = kMaxNumbersKept / std::max<size_t>(rows.numbers(), 1);
  return {std::min(kOfNumbers.rows, max), kOfNumbers.predictions};
}

size_t InstanceHistory::values_wanted(const idf::Data& value) const {
  const ValueRow rows(value, inputs_.type ? &*inputs_.type : nullptr);
  const size_t window = window_of(rows).rows;
  // Engines learn from more rows of numbers than they are measured on. Images cost too much to read
  // for that.
  return rows.other_members().empty() ? std::max(window, kOfNumbers.rows) : window;
}

void InstanceHistory::start(const idf::Data& value) {
  rows_.emplace(value, inputs_.type ? &*inputs_.type : nullptr, has_rotations_);
  samples_of_.emplace(*rows_);
  window_ = window_of(*rows_);
  const size_t max = kMaxNumbersKept / std::max<size_t>(rows_->numbers(), 1);
  series_ = std::make_unique<NumberSeries>(rows_->numbers(), std::min(kOfNumbers.rows, max));
  samples_.clear();
  values_.clear();
}

bool InstanceHistory::add(Time time, const idf::Data& value) {
  bool is_new = false;
  auto split = rows_ ? rows_->layout().split(value) : Result<idf::SplitValue>(not_found("none"));
  if (!split.ok()) {
    has_rotations_ = true;
    start(value);
    is_new = true;
    split = rows_->layout().split(value);
  }
  const auto before = [this] {
    return series_->rows() == 0 ? std::span<const double>() : last_row();
  };
  std::vector<double> row(rows_->numbers());
  // A member that held a rotation by chance, or holds none now, would break the turns of its row:
  // the history starts again with rotations as plain numbers.
  if (!rows_->read(*split, before(), row)) {
    has_rotations_ = false;
    start(value);
    is_new = true;
    split = rows_->layout().split(value);
    row.resize(rows_->numbers());
    const bool is_read = rows_->read(*split, {}, row);
    ENGRAM_CHECK(is_read, "a value without rotations");
  }
  const Status added = series_->add(time, row);
  ENGRAM_CHECK(added.ok(), "{}", added.message());
  if (!rows_->other_members().empty()) samples_.push_back(samples_of_->sample(*split));
  values_.push_back(value);
  while (samples_.size() > window_.rows) samples_.pop_front();
  while (values_.size() > (has_models() ? window_.rows : 1)) values_.pop_front();
  last_ = std::move(*split);
  return is_new;
}

/// Puts the mean squares of images and large arrays at the indices of their members.
MemberErrors InstanceHistory::members_of(const MemberSample& recorded,
                                         const MemberSample& other) const {
  MemberErrors errors{samples_of_->difference(recorded, other), {}};
  errors.squares.assign(rows_->layout().members().size(), kNaN);
  const std::vector<double> squares = samples_of_->differences(recorded, other);
  for (size_t i = 0; i < squares.size(); ++i)
    errors.squares[rows_->other_members()[i]] = squares[i];
  return errors;
}

std::optional<MemberErrors> InstanceHistory::copied_error(size_t from, size_t to) const {
  const size_t first = series_->rows() - samples_.size();
  if (samples_.empty() || from < first) return std::nullopt;
  return members_of(samples_[to - first], samples_[from - first]);
}

Result<MemberErrors> InstanceHistory::error_of(const idf::Data& predicted, size_t from,
                                               size_t to) const {
  ENGRAM_ASSIGN_OR_RETURN(const auto split, rows_->layout().split(predicted));
  std::vector<double> row(rows_->numbers());
  if (!rows_->read(split, series_->row(from), row))
    return invalid_argument("found a rotation that is none");
  const size_t first = series_->rows() - samples_.size();
  MemberErrors errors{{kNaN, kNaN}, std::vector<double>(rows_->layout().members().size(), kNaN)};
  if (!samples_.empty() && to >= first)
    errors = members_of(samples_[to - first], samples_of_->sample(split));
  for (const RowMember& member : rows_->row_members())
    errors.squares[member.member] =
        finite_or_nan(ValueRow::mean_square(member, row, series_->row(to)));
  errors.pooled.number_mse =
      joined_error(finite_or_nan(rows_->mean_square(row, series_->row(to))), rows_->counted(),
                   errors.pooled.number_mse, samples_of_->number_elements());
  return errors;
}

}  // namespace engram::ltm
