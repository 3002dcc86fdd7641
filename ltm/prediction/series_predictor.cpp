// SPDX-License-Identifier: Apache-2.0
#include "ltm/prediction/series_predictor.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "ltm/prediction/error_bound.h"

namespace engram::ltm {

namespace {

/// Engines are measured again after this many more rows, relative to the rows at the last time.
constexpr double kMoreRows = 0.1;
/// Blocks of the rows that engines are measured on. Engines learn again before each block.
constexpr size_t kBlocks = 3;
/// Max horizons that are kept. Clients may ask for any horizon, so beyond this all are dropped.
constexpr size_t kMaxHorizons = 64;
/// A horizon that is closer than this to a whole number of steps is taken as whole. Unit: steps.
constexpr double kCloseToStep = 0.05;

double mean_square(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum / static_cast<double>(a.size());
}

/// Makes the record of an engine from its mean squared errors.
SeriesRecord record_of(std::string_view engine, std::vector<double> mean_squares) {
  SeriesRecord record{std::string(engine), mean_squares.size()};
  if (mean_squares.empty()) return record;
  double sum = 0;
  for (const double one : mean_squares) sum += one;
  record.rmse = std::sqrt(sum / static_cast<double>(mean_squares.size()));
  record.bound_rmse = std::sqrt(bound_of(std::move(mean_squares)));
  return record;
}

}  // namespace

SeriesPredictor::SeriesPredictor(const NumberSeries& series, std::optional<ValueRow> meaning,
                                 Options options)
    : series_(series),
      meaning_(std::move(meaning)),
      options_(options),
      engines_(make_series_engines()) {}

size_t SeriesPredictor::learned_rows() const {
  // Without numbers nothing is learned, so predictions can be measured on all rows.
  return series_.numbers() == 0 ? 0 : series_.rows() * 2 / 3;
}

std::vector<size_t> SeriesPredictor::test_rows(size_t steps) const {
  std::vector<size_t> rows;
  const size_t split = learned_rows();
  const size_t none_before = series_.rows() - std::min(series_.rows(), options_.last_rows);
  for (size_t row = std::max(split - std::min(split, steps), none_before);
       row + steps < series_.rows(); ++row)
    if (series_.run_start(row + steps) <= row) rows.push_back(row);
  if (rows.size() <= options_.max_predictions) return rows;
  std::vector<size_t> some;
  if (options_.is_anchored) {
    const size_t every = (rows.size() - 1) / options_.max_predictions + 1;
    // Rows are counted from the first one ever added, so the same rows are used again after more
    // came, and what a model was measured on there need not be measured again.
    const uint64_t forgotten = series_.added() - series_.rows();
    std::ranges::copy_if(rows, std::back_inserter(some),
                         [&](size_t row) { return (forgotten + row) % every == 0; });
    return some;
  }
  for (size_t i = 0; i < options_.max_predictions; ++i)
    some.push_back(rows[i * rows.size() / options_.max_predictions]);
  return some;
}

const std::vector<RowMember>& SeriesPredictor::members() const {
  static const std::vector<RowMember> kNone;
  return meaning_ ? meaning_->row_members() : kNone;
}

SeriesPredictor::MeasuredEngine SeriesPredictor::measure(SeriesEngine& engine, size_t steps) {
  const size_t split = learned_rows();
  const std::vector<RowMember>& members = this->members();
  const MemberMotion& motion = this->motion();
  std::vector<double> predicted(series_.numbers());
  std::vector<double> mean_squares;
  std::vector<MotionErrors> errors(members.size());
  size_t learned_until = 0;
  for (const size_t row : test_rows(steps)) {
    // Engines may know only rows before the block, as they would have at that time.
    const size_t block = std::min(
        kBlocks - 1, (row + steps - split) * kBlocks / std::max<size_t>(series_.rows() - split, 1));
    const size_t known = split + block * (series_.rows() - split) / kBlocks;
    if (known > learned_until) engine.learn(series_, known, steps);
    learned_until = std::max(learned_until, known);
    const auto truth = series_.row(row + steps);
    engine.predict(series_, row, steps, predicted);
    if (meaning_) meaning_->finish(series_.row(row), predicted);
    mean_squares.push_back(meaning_ ? meaning_->mean_square(predicted, truth)
                                    : mean_square(predicted, truth));
    for (size_t i = 0; i < members.size(); ++i)
      errors[i].add(motion.is_moving(series_, row, members[i], i),
                    ValueRow::mean_square(members[i], predicted, truth));
  }
  MeasuredEngine measured{record_of(engine.name(), std::move(mean_squares)),
                          {std::string(engine.name()), {}}};
  for (MotionErrors& one : errors) measured.members.members.push_back(std::move(one).records());
  if (!engine.learns()) measure_movements(engine, steps, measured.members);
  return measured;
}

/// Measures predictions from all rows at which a member moves. Other rows cost only the test.
void SeriesPredictor::measure_movements(const SeriesEngine& engine, size_t steps,
                                        MemberRecords& records) {
  const std::vector<RowMember>& members = this->members();
  const MemberMotion& motion = this->motion();
  std::vector<std::vector<double>> squares(members.size());
  std::vector<double> predicted(series_.numbers());
  std::vector<size_t> moving;
  for (size_t row = 0; row + steps < series_.rows(); ++row) {
    if (series_.run_start(row + steps) > row) continue;
    moving.clear();
    for (size_t i = 0; i < members.size(); ++i)
      if (squares[i].size() < options_.max_predictions &&
          motion.is_moving(series_, row, members[i], i))
        moving.push_back(i);
    if (moving.empty()) continue;
    engine.predict(series_, row, steps, predicted);
    meaning_->finish(series_.row(row), predicted);
    for (const size_t i : moving)
      squares[i].push_back(ValueRow::mean_square(members[i], predicted, series_.row(row + steps)));
  }
  for (size_t i = 0; i < members.size(); ++i)
    records.members[i].ever_moving = MemberRecord::of(std::move(squares[i]));
}

bool SeriesPredictor::is_fresh(uint64_t rows_then) const {
  const auto enough = static_cast<uint64_t>(std::ceil(static_cast<double>(rows_then) * kMoreRows));
  return series_.added() < rows_then + std::max<uint64_t>(enough, 1);
}

/// Measures the engines of that name, or all, unless that was done a short while ago. A program
/// that names an engine need not wait for the others, of which some search long for what they
/// learn.
std::vector<SeriesPredictor::MeasuredEngine> SeriesPredictor::measured(
    Duration ahead, std::span<const std::string_view> names) {
  const size_t steps = series_.steps_in(ahead);
  if (measured_.size() >= kMaxHorizons && !measured_.contains(steps)) {
    measured_.clear();
    learned_.clear();
    engines_ = make_series_engines();
  }
  Measured& known = measured_[steps];
  const auto engines = make_series_engines();
  const auto is_wanted = [&](const auto& engine) {
    return names.empty() || std::ranges::find(names, engine->name()) != names.end();
  };
  const bool has_all = std::ranges::all_of(engines, [&](const auto& engine) {
    return !is_wanted(engine) || known.engines.contains(engine->name());
  });
  // All errors are of the same rows: an engine would win if its rows were easier than the others'.
  if (!is_fresh(known.rows) || (!has_all && known.rows != series_.added()))
    known = {series_.added(), {}};
  std::vector<MeasuredEngine> wanted;
  for (const auto& engine : engines) {
    if (!is_wanted(engine)) continue;
    auto one = known.engines.find(engine->name());
    if (one == known.engines.end())
      one = known.engines.emplace(engine->name(), measure(*engine, steps)).first;
    wanted.push_back(one->second);
  }
  return wanted;
}

std::vector<SeriesRecord> SeriesPredictor::records(Duration ahead) {
  std::vector<SeriesRecord> records;
  for (MeasuredEngine& one : measured(ahead, {})) records.push_back(std::move(one.record));
  std::ranges::stable_sort(records, {}, &SeriesRecord::rmse);
  return records;
}

std::vector<MemberRecords> SeriesPredictor::member_records(
    Duration ahead, std::span<const std::string_view> names) {
  std::vector<MemberRecords> records;
  for (MeasuredEngine& one : measured(ahead, names)) records.push_back(std::move(one.members));
  return records;
}

const MemberMotion& SeriesPredictor::motion() {
  if (!motion_ || !is_fresh(motion_rows_)) {
    motion_.emplace(series_, members());
    motion_rows_ = series_.added();
  }
  return *motion_;
}

std::vector<bool> SeriesPredictor::moving_members(size_t row) {
  const MemberMotion& motion = this->motion();
  std::vector<bool> moving;
  for (size_t i = 0; i < members().size(); ++i)
    moving.push_back(motion.is_moving(series_, row, members()[i], i));
  return moving;
}

std::vector<double> SeriesPredictor::predicted_row(size_t engine, size_t steps) {
  const size_t last = series_.rows() - 1;
  std::vector<double> row(series_.row(last).begin(), series_.row(last).end());
  if (steps == 0) return row;
  const auto learned = learned_.find({steps, engine});
  if (learned == learned_.end() || !is_fresh(learned->second)) {
    engines_[engine]->learn(series_, series_.rows(), steps);
    learned_[{steps, engine}] = series_.added();
  }
  engines_[engine]->predict(series_, last, steps, row);
  return row;
}

std::vector<double> SeriesPredictor::continued(Duration ahead, const std::string& engine) {
  ENGRAM_CHECK(series_.rows() > 0 && ahead > Duration(0), "found {} rows and {} ahead",
               series_.rows(), to_string(ahead));
  const auto found =
      std::ranges::find(engines_, engine, [](const auto& one) { return one->name(); });
  ENGRAM_CHECK(found != engines_.end(), "found no engine '{}'", engine);
  const auto used = static_cast<size_t>(found - engines_.begin());
  const size_t steps = series_.steps_in(ahead);
  std::vector<double> values = predicted_row(used, steps);
  // A horizon beside the closest step lies between that step and its neighbour on that side.
  const double exact =
      series_.step() > Duration(0) ? to_seconds(ahead) / to_seconds(series_.step()) : 1.0;
  const double beside = exact - static_cast<double>(steps);
  if (std::abs(beside) > kCloseToStep) {
    const auto other = predicted_row(used, beside < 0 ? steps - 1 : steps + 1);
    for (size_t i = 0; i < other.size(); ++i)
      values[i] += std::abs(beside) * (other[i] - values[i]);
  }
  if (meaning_) meaning_->finish(series_.row(series_.rows() - 1), values);
  return values;
}

Result<SeriesPrediction> SeriesPredictor::predict(Duration ahead, const std::string& engine) {
  if (series_.rows() == 0) return not_found("series: found no row, needs one to predict from");
  if (ahead <= Duration(0))
    return invalid_argument("series: found a horizon of {}, needs more than zero",
                            to_string(ahead));
  const auto has_name = [&](const auto& one) { return one->name() == engine; };
  if (!engine.empty() && std::ranges::none_of(engines_, has_name)) {
    std::string names;
    for (const auto& known : engines_)
      names += (names.empty() ? "" : ", ") + std::string(known->name());
    return not_found("series: nothing named '{}' predicts it; there is: {}", engine, names);
  }
  const std::string_view name = engine;
  SeriesRecord record = engine.empty() ? this->records(ahead).front()
                                       : std::move(measured(ahead, {&name, 1}).front().record);
  std::vector<double> values = continued(ahead, record.engine);
  return SeriesPrediction{std::move(values), std::move(record)};
}

}  // namespace engram::ltm
