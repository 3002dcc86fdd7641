// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "ltm/prediction/series_engine.h"

namespace engram::ltm {

namespace {

constexpr size_t kLineRows = 5;
constexpr double kDamping = 0.7;

class CopyLast final : public SeriesEngine {
 public:
  [[nodiscard]] std::string_view name() const override { return kCopyLast; }
  void predict(const NumberSeries& series, size_t row, size_t /*steps*/,
               std::span<double> predicted) const override {
    std::ranges::copy(series.row(row), predicted.begin());
  }
};

/// Number of rows of the run up to and including `row`, at most `max`.
size_t rows_until(const NumberSeries& series, size_t row, size_t max) {
  return std::min(row - series.run_start(row) + 1, max);
}

/// The slope per step of the line through the last `count` rows.
double slope(const NumberSeries& series, size_t row, size_t count, size_t number) {
  const double middle = static_cast<double>(count - 1) / 2;
  double products = 0, squares = 0;
  for (size_t i = 0; i < count; ++i) {
    const double place = static_cast<double>(i) - middle;
    products += place * series.row(row - (count - 1) + i)[number];
    squares += place * place;
  }
  return count < 2 ? 0 : products / squares;
}

class Line final : public SeriesEngine {
 public:
  [[nodiscard]] std::string_view name() const override { return "line"; }
  void predict(const NumberSeries& series, size_t row, size_t steps,
               std::span<double> predicted) const override {
    const size_t count = rows_until(series, row, kLineRows);
    const double ahead = static_cast<double>(steps) + static_cast<double>(count - 1) / 2;
    for (size_t number = 0; number < predicted.size(); ++number) {
      double sum = 0;
      for (size_t i = 0; i < count; ++i) sum += series.row(row - i)[number];
      predicted[number] =
          sum / static_cast<double>(count) + slope(series, row, count, number) * ahead;
    }
  }
};

/// Continues from the last value with a share of the slope. Unlike Line it has no jump at the first
/// step, as it starts from the last value and not from the line.
class Moved final : public SeriesEngine {
 public:
  Moved(std::string_view name, size_t rows, double share)
      : name_(name), rows_(rows), share_(share) {}
  [[nodiscard]] std::string_view name() const override { return name_; }
  void predict(const NumberSeries& series, size_t row, size_t steps,
               std::span<double> predicted) const override {
    const size_t count = rows_until(series, row, rows_);
    for (size_t number = 0; number < predicted.size(); ++number)
      predicted[number] = series.row(row)[number] +
                          share_ * static_cast<double>(steps) * slope(series, row, count, number);
  }

 private:
  std::string_view name_;
  size_t rows_;
  double share_;
};

/// Continues with the last change and the change of the changes between the last three values.
class Quadratic final : public SeriesEngine {
 public:
  [[nodiscard]] std::string_view name() const override { return "quadratic"; }
  void predict(const NumberSeries& series, size_t row, size_t steps,
               std::span<double> predicted) const override {
    const size_t count = rows_until(series, row, 3);
    const auto ahead = static_cast<double>(steps);
    for (size_t number = 0; number < predicted.size(); ++number) {
      const double last = series.row(row)[number];
      const double change = count < 2 ? 0 : last - series.row(row - 1)[number];
      const double bend =
          count < 3 ? 0 : change - (series.row(row - 1)[number] - series.row(row - 2)[number]);
      predicted[number] = last + ahead * change + ahead * (ahead + 1) / 2 * bend;
    }
  }
};

}  // namespace

std::unique_ptr<SeriesEngine> make_copy_last() {
  return std::make_unique<CopyLast>();
}
std::unique_ptr<SeriesEngine> make_line() {
  return std::make_unique<Line>();
}
std::unique_ptr<SeriesEngine> make_damped_line() {
  return std::make_unique<Moved>("damped-line", kLineRows, kDamping);
}
std::unique_ptr<SeriesEngine> make_constant_velocity() {
  return std::make_unique<Moved>("constant-velocity", 2, 1.0);
}

std::unique_ptr<SeriesEngine> make_quadratic() {
  return std::make_unique<Quadratic>();
}

std::vector<std::unique_ptr<SeriesEngine>> make_series_engines() {
  std::vector<std::unique_ptr<SeriesEngine>> engines;
  engines.push_back(make_copy_last());
  engines.push_back(make_line());
  engines.push_back(make_damped_line());
  engines.push_back(make_constant_velocity());
  engines.push_back(make_quadratic());
  engines.push_back(make_autoregression());
  engines.push_back(make_related());
  return engines;
}

}  // namespace engram::ltm
