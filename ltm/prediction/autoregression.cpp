// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Dense>
#include <map>

#include "ltm/prediction/series_engine.h"

namespace engram::ltm {

namespace {

constexpr int kChanges = 7;
/// Weight of the ridge, relative to the mean square of a change.
constexpr double kRidge = 1e-3;
/// Min windows to learn weights from.
constexpr size_t kMinWindows = 40;

using Changes = Eigen::Matrix<double, kChanges, 1>;
using Products = Eigen::Matrix<double, kChanges, kChanges>;

bool has_changes(const NumberSeries& series, size_t row) {
  return row >= series.run_start(row) + kChanges;
}

Changes changes_of(const NumberSeries& series, size_t row, size_t number) {
  Changes changes;
  for (int i = 0; i < kChanges; ++i) {
    const size_t later = row - static_cast<size_t>(i);
    changes[i] = series.row(later)[number] - series.row(later - 1)[number];
  }
  return changes;
}

class Autoregression final : public SeriesEngine {
 public:
  [[nodiscard]] std::string_view name() const override { return "autoregression"; }
  [[nodiscard]] bool learns() const override { return true; }

  void learn(const NumberSeries& series, size_t end, size_t steps) override {
    std::vector<size_t> windows;
    for (size_t row = 0; row + steps < end; ++row)
      if (has_changes(series, row) && series.run_start(row + steps) <= row) windows.push_back(row);
    auto& weights = weights_[steps];
    weights.assign(series.numbers(), Changes::Zero());
    if (windows.size() < kMinWindows) return;
    for (size_t number = 0; number < series.numbers(); ++number)
      weights[number] = learned(series, windows, steps, number);
  }

  void predict(const NumberSeries& series, size_t row, size_t steps,
               std::span<double> predicted) const override {
    const auto known = weights_.find(steps);
    const bool is_known = known != weights_.end() && has_changes(series, row);
    for (size_t number = 0; number < predicted.size(); ++number) {
      predicted[number] = series.row(row)[number];
      if (is_known) predicted[number] += known->second[number].dot(changes_of(series, row, number));
    }
  }

 private:
  static Changes learned(const NumberSeries& series, std::span<const size_t> windows, size_t steps,
                         size_t number) {
    Products squares = Products::Zero();
    Changes products = Changes::Zero();
    for (const size_t row : windows) {
      const Changes changes = changes_of(series, row, number);
      squares.noalias() += changes * changes.transpose();
      products += changes * (series.row(row + steps)[number] - series.row(row)[number]);
    }
    const double size = squares.diagonal().mean();
    if (!(size > 0)) return Changes::Zero();  // The number never changes.
    squares.diagonal().array() += kRidge * size;
    const Changes weights = squares.ldlt().solve(products);
    return weights.allFinite() ? weights : Changes::Zero();  // Squares of huge numbers overflow.
  }

  std::map<size_t, std::vector<Changes>> weights_;  ///< One per number; the key is the steps.
};

}  // namespace

std::unique_ptr<SeriesEngine> make_autoregression() {
  return std::make_unique<Autoregression>();
}

}  // namespace engram::ltm
