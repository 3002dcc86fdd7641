// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>

#include "ltm/prediction/series_engine.h"

namespace engram::ltm {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kRelatedChanges = 7;
/// Features of one number: its level, then its last changes.
constexpr Index kFeatures = kRelatedChanges + 1;
/// With more numbers nothing is learned, because the search costs the square of their number.
constexpr size_t kMaxNumbers = 96;
constexpr size_t kMinRelatedWindows = 120;
constexpr size_t kMaxWindows = 2048;
/// Share of the windows, the last ones, on which it is decided how many features to use.
constexpr double kHeldOut = 0.25;
constexpr size_t kMaxPicks = 8;
/// Weight of the ridge, relative to the square of each feature.
constexpr double kRelatedRidge = 1e-2;
/// Min gain of picked features on held-out windows, relative to the error without them. Among many
/// features one always helps a little by chance.
constexpr double kMinGain = 0.01;

/// The chosen features and their weights.
struct Weights {
  std::vector<Index> features;
  VectorXd weights;
};

/// Sums of products over windows. Least squares needs nothing else, so any subset of the features
/// can be fitted without reading the windows again.
struct RelatedProducts {
  MatrixXd features;  ///< [F, F]
  MatrixXd targets;   ///< [F, numbers]
  VectorXd squares;   ///< [numbers], of the targets.

  static RelatedProducts of(const MatrixXd& x, const MatrixXd& y) {
    return {x.transpose() * x, x.transpose() * y, y.colwise().squaredNorm().transpose()};
  }
};

Weights fitted(const RelatedProducts& products, std::vector<Index> features, Index target) {
  MatrixXd squares = products.features(features, features);
  squares.diagonal() *= 1 + kRelatedRidge;
  const VectorXd wanted = products.targets(features, Eigen::all).col(target);
  VectorXd weights = squares.ldlt().solve(wanted);
  if (!weights.allFinite()) weights.setZero();  // Squares of huge numbers overflow.
  return {std::move(features), std::move(weights)};
}

double error_of(const RelatedProducts& products, const Weights& fit, Index target) {
  const VectorXd wanted = products.targets(fit.features, Eigen::all).col(target);
  return products.squares[target] - 2 * fit.weights.dot(wanted) +
         fit.weights.dot(products.features(fit.features, fit.features) * fit.weights);
}

/// The feature that explains most of what a fit leaves, apart from what its own features explain
/// of it; -1 if there is none.
Index best_pick(const RelatedProducts& products, const Weights& fit, Index target) {
  MatrixXd squares = products.features(fit.features, fit.features);
  squares.diagonal() *= 1 + kRelatedRidge;
  const MatrixXd cross = products.features(fit.features, Eigen::all);  // [S, F]
  const VectorXd left = products.targets.col(target) - cross.transpose() * fit.weights;
  const MatrixXd explained = squares.ldlt().solve(cross);
  Index best = -1;
  double max = 0;
  for (Index feature = 0; feature < left.size(); ++feature) {
    const double all = products.features(feature, feature);
    const double own = all * (1 + kRelatedRidge) - cross.col(feature).dot(explained.col(feature));
    if (!(own > kRelatedRidge * all) ||
        std::ranges::find(fit.features, feature) != fit.features.end())
      continue;
    const double gain = left[feature] * left[feature] / own;
    if (gain > max) {
      max = gain;
      best = feature;
    }
  }
  return best;
}

class Related final : public SeriesEngine {
 public:
  [[nodiscard]] std::string_view name() const override { return "related"; }
  [[nodiscard]] bool learns() const override { return true; }

  void learn(const NumberSeries& series, size_t end, size_t steps) override {
    auto& learned = weights_[steps];
    learned.clear();
    const std::vector<size_t> windows = windows_of(series, end, steps);
    if (series.numbers() > kMaxNumbers || windows.size() < kMinRelatedWindows) return;
    learn_means(series, windows);
    MatrixXd x(windows.size(), kFeatures * static_cast<Index>(series.numbers()));
    MatrixXd y(windows.size(), series.numbers());
    for (size_t i = 0; i < windows.size(); ++i)
      for (size_t number = 0; number < series.numbers(); ++number) {
        const auto row = static_cast<Index>(i), column = static_cast<Index>(number);
        for (Index k = 0; k < kFeatures; ++k)
          x(row, column * kFeatures + k) = feature(series, windows[i], column * kFeatures + k);
        y(row, column) = series.row(windows[i] + steps)[number] - series.row(windows[i])[number];
      }
    const auto held_out = static_cast<Index>(kHeldOut * static_cast<double>(windows.size()));
    const RelatedProducts first =
        RelatedProducts::of(x.topRows(x.rows() - held_out), y.topRows(y.rows() - held_out));
    const RelatedProducts last =
        RelatedProducts::of(x.bottomRows(held_out), y.bottomRows(held_out));
    const RelatedProducts all{first.features + last.features, first.targets + last.targets,
                              first.squares + last.squares};
    // Features are chosen on a part of the windows, but their weights are fitted on all of them.
    for (Index number = 0; number < y.cols(); ++number)
      learned.push_back(fitted(all, features_for(first, last, number), number));
  }

  void predict(const NumberSeries& series, size_t row, size_t steps,
               std::span<double> predicted) const override {
    std::ranges::copy(series.row(row), predicted.begin());
    const auto known = weights_.find(steps);
    if (known == weights_.end() || known->second.empty() || !has_changes(series, row)) return;
    for (size_t number = 0; number < predicted.size(); ++number) {
      const Weights& fit = known->second[number];
      for (size_t i = 0; i < fit.features.size(); ++i)
        predicted[number] +=
            fit.weights[static_cast<Index>(i)] * feature(series, row, fit.features[i]);
    }
  }

 private:
  static bool has_changes(const NumberSeries& series, size_t row) {
    return row >= series.run_start(row) + kRelatedChanges;
  }

  static std::vector<size_t> windows_of(const NumberSeries& series, size_t end, size_t steps) {
    std::vector<size_t> all, some;
    for (size_t row = 0; row + steps < end; ++row)
      if (has_changes(series, row) && series.run_start(row + steps) <= row) all.push_back(row);
    const size_t count = std::min(all.size(), kMaxWindows);
    for (size_t i = 0; i < count; ++i) some.push_back(all[i * all.size() / count]);
    return some;
  }

  void learn_means(const NumberSeries& series, std::span<const size_t> windows) {
    means_.assign(series.numbers(), 0);
    for (const size_t row : windows)
      for (size_t number = 0; number < means_.size(); ++number)
        means_[number] += series.row(row)[number] / static_cast<double>(windows.size());
  }

  [[nodiscard]] double feature(const NumberSeries& series, size_t row, Index feature) const {
    const auto number = static_cast<size_t>(feature / kFeatures);
    const auto back = static_cast<size_t>(feature % kFeatures);
    if (back == 0) return series.row(row)[number] - means_[number];
    return series.row(row - back + 1)[number] - series.row(row - back)[number];
  }

  /// The features of a number: its own changes, and its level and further features as long as they
  /// reduce the error on held-out windows.
  static std::vector<Index> features_for(const RelatedProducts& first, const RelatedProducts& last,
                                         Index number) {
    std::vector<Index> features;
    for (Index k = 1; k < kFeatures; ++k) features.push_back(number * kFeatures + k);
    Weights fit = fitted(first, features, number);
    double min = error_of(last, fit, number) * (1 - kMinGain);
    std::vector<Index> best = features;
    features.push_back(number * kFeatures);
    for (size_t picks = 0; picks <= kMaxPicks; ++picks) {
      fit = fitted(first, features, number);
      const double error = error_of(last, fit, number);
      if (error < min) {
        min = error * (1 - kMinGain);
        best = features;
      }
      const Index pick = best_pick(first, fit, number);
      if (pick < 0) break;
      features.push_back(pick);
    }
    return best;
  }

  std::vector<double> means_;
  std::map<size_t, std::vector<Weights>> weights_;  ///< One per number; the key is the steps.
};

}  // namespace

std::unique_ptr<SeriesEngine> make_related() {
  return std::make_unique<Related>();
}

}  // namespace engram::ltm
