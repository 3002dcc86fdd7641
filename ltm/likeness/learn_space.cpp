// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/learn_space.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "ltm/core/check.h"
#include "ltm/likeness/likeness_space.h"

namespace engram::ltm {

namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr Eigen::Index kComponents = 64;
/// Pairs tell little of directions in which there is little of anything.
constexpr double kPairShrinkage = 0.1;
/// The deviation of codes over all samples, in steps of their rounding: a code of ten deviations
/// still fits a byte.
constexpr double kCodeDeviation = 12;
/// How many other recordings a moment is paired with.
constexpr size_t kPartners = 5;
/// A long recording counts as several, so that a robot that never stops has pairs, too.
constexpr Duration kMaxRecording = std::chrono::minutes(5);

Matrix rows_of(const std::vector<std::vector<float>>& descriptors) {
  Matrix rows(static_cast<Eigen::Index>(descriptors.size()),
              static_cast<Eigen::Index>(kDescriptorSize));
  for (size_t i = 0; i < descriptors.size(); ++i)
    rows.row(static_cast<Eigen::Index>(i)) =
        Eigen::Map<const Eigen::RowVectorXf>(descriptors[i].data(), rows.cols()).cast<double>();
  return rows;
}

/// Each column with mean 0 and deviation 1; columns that never change become 0.
Matrix standardised(const std::vector<std::vector<double>>& views) {
  Matrix rows(static_cast<Eigen::Index>(views.size()),
              static_cast<Eigen::Index>(views.front().size()));
  for (size_t i = 0; i < views.size(); ++i)
    rows.row(static_cast<Eigen::Index>(i)) =
        Eigen::Map<const Eigen::RowVectorXd>(views[i].data(), rows.cols());
  rows.rowwise() -= rows.colwise().mean().eval();
  // A joint that only trembles must not count like one that moves.
  constexpr double kTremble = 0.01;
  for (Eigen::Index j = 0; j < rows.cols(); ++j) {
    const double deviation =
        std::sqrt(rows.col(j).squaredNorm() / static_cast<double>(rows.rows()));
    rows.col(j) /= deviation + kTremble;
  }
  return rows;
}

std::vector<Sequence> short_recordings(const LikenessSamples& samples) {
  std::vector<Sequence> parts;
  for (const Sequence& recording : samples.recordings) {
    size_t first = recording.first;
    for (size_t i = recording.first; i < recording.end; ++i)
      if (samples.times[i] - samples.times[first] > kMaxRecording) {
        parts.push_back({first, i});
        first = i;
      }
    parts.push_back({first, recording.end});
  }
  return parts;
}

/// The principal components of centred rows, as columns, those of the largest variance first.
Matrix principal_components(const Matrix& centred) {
  const Matrix covariance = centred.transpose() * centred /
                            static_cast<double>(std::max<Eigen::Index>(centred.rows(), 1));
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(covariance);
  return solver.eigenvectors().rowwise().reverse().leftCols(
      std::min(kComponents, covariance.cols()));
}

/// Directions as columns, in the space of the components.
Matrix discriminating(const Matrix& parts, const std::vector<std::pair<size_t, size_t>>& pairs) {
  const Matrix all = parts.transpose() * parts / static_cast<double>(parts.rows());
  Matrix within = Matrix::Zero(parts.cols(), parts.cols());
  for (const auto& [a, b] : pairs) {
    const Vector difference =
        (parts.row(static_cast<Eigen::Index>(a)) - parts.row(static_cast<Eigen::Index>(b)))
            .transpose();
    within.selfadjointView<Eigen::Lower>().rankUpdate(difference);
  }
  within = within.selfadjointView<Eigen::Lower>();
  within /= 2.0 * static_cast<double>(pairs.size());
  const double mean = within.trace() / static_cast<double>(within.cols());
  within.diagonal().array() += kPairShrinkage * mean + std::numeric_limits<double>::min();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(all, within);
  return solver.eigenvectors().rowwise().reverse();
}

}  // namespace

std::vector<std::pair<size_t, size_t>> alike_pairs(const LikenessSamples& samples) {
  if (samples.views.empty() || samples.views.front().empty()) return {};
  const Matrix views = standardised(samples.views);
  if (views.squaredNorm() == 0) return {};  // Nothing moved, so nothing tells what is alike.
  const std::vector<Sequence> recordings = short_recordings(samples);
  struct Pair {
    double distance = 0;
    size_t a = 0, b = 0;
  };
  std::vector<Pair> pairs;
  for (size_t own = 0; own < recordings.size(); ++own) {
    const size_t others = std::min(kPartners, recordings.size() - 1);
    for (size_t i = recordings[own].first; i < recordings[own].end; ++i)
      for (size_t k = 0; k < others; ++k) {
        // Partners are spread over all other recordings, and differ from moment to moment.
        const size_t ahead =
            1 + (k * (recordings.size() - 1) / others + i) % (recordings.size() - 1);
        const Sequence& other = recordings[(own + ahead) % recordings.size()];
        Pair nearest{std::numeric_limits<double>::infinity(), i, i};
        for (size_t j = other.first; j < other.end; ++j) {
          const double distance =
              (views.row(static_cast<Eigen::Index>(i)) - views.row(static_cast<Eigen::Index>(j)))
                  .squaredNorm();
          if (distance < nearest.distance) nearest = {distance, i, j};
        }
        if (nearest.a != nearest.b) pairs.push_back(nearest);
      }
  }
  const auto half = pairs.begin() + static_cast<std::ptrdiff_t>(pairs.size() / 2);
  std::ranges::nth_element(pairs, half, {}, &Pair::distance);
  std::vector<std::pair<size_t, size_t>> nearer;
  for (auto pair = pairs.begin(); pair != half; ++pair) nearer.emplace_back(pair->a, pair->b);
  return nearer;
}

LearnedProjection learn_projection(const LikenessSamples& samples) {
  ENGRAM_CHECK(samples.descriptors.size() >= 2, "a space needs two samples, found {}",
               samples.descriptors.size());
  Matrix rows = rows_of(samples.descriptors);
  const Vector mean = rows.colwise().mean().transpose();
  rows.rowwise() -= mean.transpose();
  Matrix directions = principal_components(rows);  // [576, 64]
  if (const auto pairs = alike_pairs(samples); !pairs.empty())
    directions = directions * discriminating(rows * directions, pairs);
  directions = directions.leftCols(static_cast<Eigen::Index>(kCodeSize)).eval();
  const Matrix codes = rows * directions;  // [N, 24]
  const double deviation =
      std::sqrt(codes.squaredNorm() / static_cast<double>(std::max<Eigen::Index>(codes.size(), 1)));
  if (deviation > 0) directions *= kCodeDeviation / deviation;
  LearnedProjection learned;
  const Eigen::VectorXf mean_floats = mean.cast<float>();
  learned.mean.assign(mean_floats.data(), mean_floats.data() + mean_floats.size());
  const Eigen::MatrixXf floats = directions.cast<float>();  // Its columns are rows of the result.
  learned.projection.assign(floats.data(), floats.data() + floats.size());
  return learned;
}

}  // namespace engram::ltm
