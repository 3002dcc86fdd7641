// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>

#include "ltm/prediction/products.h"
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
    return {squared(x), product(x, y), y.colwise().squaredNorm().transpose()};
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

/// Features that are added one by one, and what each further one would explain of what those before
/// it leave. This is Gram-Schmidt on the products: a feature costs one product of F numbers with
/// each feature before it, where solving for all F anew would cost the square of those.
class Search {
 public:
  Search(const RelatedProducts& products, Index target)
      : products_(products),
        directions_(products.features.rows(), kFeatures + static_cast<Index>(kMaxPicks) + 1),
        own_(products.features.diagonal() * (1 + kRelatedRidge)),
        left_(products.targets.col(target)) {}

  [[nodiscard]] const std::vector<Index>& features() const { return features_; }

  void add(Index feature) {
    // A feature that never changes explains nothing.
    if (own_[feature] > 0) {
      const double root = std::sqrt(own_[feature]);
      auto direction = directions_.col(count_);
      direction = products_.features.col(feature);
      if (count_ > 0)
        direction.noalias() -=
            directions_.leftCols(count_) * directions_.row(feature).head(count_).transpose().eval();
      direction /= root;
      ++count_;
      left_ -= (left_[feature] / root) * direction;
      own_ -= direction.cwiseAbs2();
    }
    features_.push_back(feature);
  }

  /// The feature that explains most of what those before it leave, apart from what they explain of
  /// it; -1 if there is none.
  [[nodiscard]] Index best() const {
    Index best = -1;
    double max = 0;
    for (Index feature = 0; feature < left_.size(); ++feature) {
      const double own = own_[feature];
      const double gain = left_[feature] * left_[feature] / own;
      if (!(gain > max) || !(own > kRelatedRidge * products_.features(feature, feature)) ||
          std::ranges::find(features_, feature) != features_.end())
        continue;
      max = gain;
      best = feature;
    }
    return best;
  }

 private:
  const RelatedProducts& products_;
  /// [F, features]: the part of each added feature that those before it do not explain, as its
  /// products with all features, relative to its own size.
  MatrixXd directions_;
  VectorXd own_;   ///< [F]: what of each feature the added ones do not explain, squared.
  VectorXd left_;  ///< [F]: products of each feature with what of the target is left.
  std::vector<Index> features_;
  Index count_ = 0;  ///< Number of directions.
};

class Related final : public SeriesEngine {
 public:
  [[nodiscard]] std::string_view name() const override { return "related"; }
  [[nodiscard]] bool learns() const override { return true; }

  void learn(const NumberSeries& series, size_t end, size_t steps) override {
    auto& learned = learned_[steps];
    learned = {};
    const std::vector<size_t> windows = windows_of(series, end, steps);
    if (series.numbers() > kMaxNumbers || windows.size() < kMinRelatedWindows) return;
    learned.means = means_of(series, windows);
    const std::span all_windows(windows);
    const auto held_out = static_cast<size_t>(kHeldOut * static_cast<double>(windows.size()));
    const RelatedProducts first =
        products_over(series, all_windows.first(windows.size() - held_out), steps, learned.means);
    const RelatedProducts last =
        products_over(series, all_windows.last(held_out), steps, learned.means);
    const RelatedProducts all{first.features + last.features, first.targets + last.targets,
                              first.squares + last.squares};
    // Features are chosen on a part of the windows, but their weights are fitted on all of them.
    for (Index number = 0; number < all.squares.size(); ++number)
      learned.weights.push_back(fitted(all, features_for(first, last, number), number));
  }

  void predict(const NumberSeries& series, size_t row, size_t steps,
               std::span<double> predicted) const override {
    std::ranges::copy(series.row(row), predicted.begin());
    const auto known = learned_.find(steps);
    if (known == learned_.end() || known->second.weights.empty() || !has_changes(series, row))
      return;
    for (size_t number = 0; number < predicted.size(); ++number) {
      const Weights& fit = known->second.weights[number];
      for (size_t i = 0; i < fit.features.size(); ++i)
        predicted[number] += fit.weights[static_cast<Index>(i)] *
                             feature(series, row, fit.features[i], known->second.means);
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

  static std::vector<double> means_of(const NumberSeries& series, std::span<const size_t> windows) {
    std::vector<double> means(series.numbers());
    for (const size_t row : windows)
      for (size_t number = 0; number < means.size(); ++number)
        means[number] += series.row(row)[number] / static_cast<double>(windows.size());
    return means;
  }

  static RelatedProducts products_over(const NumberSeries& series, std::span<const size_t> windows,
                                       size_t steps, std::span<const double> means) {
    const auto rows = static_cast<Index>(windows.size());
    MatrixXd x(rows, kFeatures * static_cast<Index>(series.numbers()));
    MatrixXd y(rows, series.numbers());
    // Column by column, as the matrices lie in memory.
    for (size_t number = 0; number < series.numbers(); ++number) {
      const auto column = static_cast<Index>(number);
      for (Index k = 0; k < kFeatures; ++k)
        for (Index i = 0; i < rows; ++i)
          x(i, column * kFeatures + k) =
              feature(series, windows[static_cast<size_t>(i)], column * kFeatures + k, means);
      for (Index i = 0; i < rows; ++i) {
        const size_t row = windows[static_cast<size_t>(i)];
        y(i, column) = series.row(row + steps)[number] - series.row(row)[number];
      }
    }
    return RelatedProducts::of(x, y);
  }

  static double feature(const NumberSeries& series, size_t row, Index feature,
                        std::span<const double> means) {
    const auto number = static_cast<size_t>(feature / kFeatures);
    const auto back = static_cast<size_t>(feature % kFeatures);
    if (back == 0) return series.row(row)[number] - means[number];
    return series.row(row - back + 1)[number] - series.row(row - back)[number];
  }

  /// The features of a number: its own changes, and its level and further features as long as they
  /// reduce the error on held-out windows.
  static std::vector<Index> features_for(const RelatedProducts& first, const RelatedProducts& last,
                                         Index number) {
    Search search(first, number);
    for (Index k = 1; k < kFeatures; ++k) search.add(number * kFeatures + k);
    double min = error_of(last, fitted(first, search.features(), number), number) * (1 - kMinGain);
    std::vector<Index> best = search.features();
    search.add(number * kFeatures);
    for (size_t picks = 0;; ++picks) {
      const double error = error_of(last, fitted(first, search.features(), number), number);
      if (error < min) {
        min = error * (1 - kMinGain);
        best = search.features();
      }
      const Index pick = picks < kMaxPicks ? search.best() : -1;
      if (pick < 0) return best;
      search.add(pick);
    }
  }

  /// What is learned for one horizon.
  struct Learned {
    std::vector<double> means;     ///< [numbers], that levels are relative to.
    std::vector<Weights> weights;  ///< [numbers]
  };

  std::map<size_t, Learned> learned_;  ///< The key is the steps.
};

}  // namespace

std::unique_ptr<SeriesEngine> make_related() {
  return std::make_unique<Related>();
}

}  // namespace engram::ltm
