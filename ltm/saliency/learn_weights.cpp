// SPDX-License-Identifier: Apache-2.0
#include "ltm/saliency/learn_weights.h"

#include <algorithm>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace engram::ltm {

namespace {

/// The ridge, as a share of the mean variance of a part.
constexpr double kRidgeShare = 0.01;

}  // namespace

void WeightLearner::add(const EntitySaliency& entity, const std::vector<bool>& read) {
  const auto reads = static_cast<uint64_t>(std::ranges::count(read, true));
  if (reads == 0 || reads == read.size()) return;
  const auto count = static_cast<double>(read.size());
  std::array<double, kFeatures> mean{};
  std::array<std::array<double, kFeatures>, kFeatures> sums{};
  std::array<double, kFeatures> read_sums{};
  for (size_t row = 0; row < read.size(); ++row) {
    const SaliencyParts parts = parts_of(entity.rows[row].parts, 0);
    for (size_t i = 0; i < kFeatures; ++i) {
      mean[i] += parts.values()[i] / count;
      if (read[row]) read_sums[i] += parts.values()[i];
      for (size_t j = 0; j < kFeatures; ++j) sums[i][j] += parts.values()[i] * parts.values()[j];
    }
  }
  for (size_t i = 0; i < kFeatures; ++i) {
    with_reads_[i] += read_sums[i] - mean[i] * static_cast<double>(reads);
    for (size_t j = 0; j < kFeatures; ++j)
      products_[i][j] += sums[i][j] - count * mean[i] * mean[j];
  }
  reads_ += reads;
}

SaliencyWeights WeightLearner::learn() const {
  SaliencyWeights weights = SaliencyWeights::standard();
  if (reads_ < kMinReads) return weights;
  double variance = 0;
  for (size_t i = 0; i < kFeatures; ++i) variance += products_[i][i] / kFeatures;
  std::vector<size_t> used;
  for (size_t i = 0; i < kFeatures; ++i)
    if (products_[i][i] > 0) used.push_back(i);
  Eigen::VectorXd found;
  while (!used.empty()) {
    const auto count = static_cast<Eigen::Index>(used.size());
    Eigen::MatrixXd left(count, count);
    Eigen::VectorXd right(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      right(i) = with_reads_[used[static_cast<size_t>(i)]];
      for (Eigen::Index j = 0; j < count; ++j)
        left(i, j) = products_[used[static_cast<size_t>(i)]][used[static_cast<size_t>(j)]];
      left(i, i) += kRidgeShare * variance;
    }
    found = left.ldlt().solve(right);
    Eigen::Index min = 0;
    if (found.minCoeff(&min) >= 0) break;
    used.erase(used.begin() + min);
  }
  if (used.empty() || !(found.sum() > 0)) return weights;
  const double share = static_cast<double>(reads_) / (static_cast<double>(reads_) + kReadsPerHalf);
  const double learned = 1 - weights.parts[SaliencyPart::kReads];
  for (size_t i = 0; i < kFeatures; ++i) weights.parts[static_cast<SaliencyPart>(i)] *= 1 - share;
  for (size_t i = 0; i < used.size(); ++i)
    weights.parts[static_cast<SaliencyPart>(used[i])] +=
        share * learned * found(static_cast<Eigen::Index>(i)) / found.sum();
  weights.learned_from = reads_;
  return weights;
}

}  // namespace engram::ltm
