// SPDX-License-Identifier: Apache-2.0
#include "training/row_sampler.h"

#include <algorithm>
#include <numeric>

#include "encoders/torch.h"

namespace engram::training {

namespace {

/// Share of the draws in which all rows are equally likely: no weight is above its inverse.
constexpr double kEqualShare = 0.5;
constexpr double kRecent = 0.3;

/// The first index whose cumulated probability is above a random number.
int64_t drawn(std::span<const double> probabilities) {
  const double total = std::reduce(probabilities.begin(), probabilities.end());
  double left = torch::rand({1}, torch::kFloat64).item<double>() * total;
  size_t last = 0;
  for (size_t i = 0; i < probabilities.size(); ++i) {
    if (probabilities[i] <= 0) continue;
    last = i;
    left -= probabilities[i];
    if (left < 0) break;
  }
  return static_cast<int64_t>(last);
}

}  // namespace

RowSampler::RowSampler(std::span<const Sequence> sequences,
                       std::span<const size_t> first_held_out) {
  for (size_t s = 0; s < sequences.size(); ++s)
    for (size_t row = sequences[s].first; row < sequences[s].end; ++row) {
      firsts_.push_back(static_cast<int64_t>(sequences[s].first));
      is_held_out_.push_back(row >= first_held_out[s]);
    }
  costs_.assign(firsts_.size(), 0.0);
}

std::vector<double> RowSampler::probabilities() const {
  const auto rows = static_cast<double>(costs_.size());
  const double told =
      static_cast<double>(std::ranges::count_if(costs_, [](double cost) { return cost > 0; }));
  const double sum = std::reduce(costs_.begin(), costs_.end());
  // Rows that nothing is known of count as usual ones.
  const double usual = told > 0 ? sum / told : 1.0;
  const double total = sum + usual * (rows - told);
  std::vector<double> result;
  for (const double cost : costs_)
    result.push_back(kEqualShare / rows + (1 - kEqualShare) * (cost > 0 ? cost : usual) / total);
  return result;
}

std::vector<RowSampler::Draw> RowSampler::draw(int64_t chunks) {
  const std::vector<double> probability = probabilities();
  const auto rows = static_cast<double>(probability.size());
  std::vector<double> likely = probability;
  std::vector<Draw> draws;
  for (int64_t i = 0; i < chunks; ++i) {
    const int64_t last = drawn(likely);
    // Among rows of one kind probabilities keep their ratios: over all batches a row is drawn as
    // often as if kinds were mixed.
    draws.push_back({last, 1.0 / (rows * probability[static_cast<size_t>(last)])});
    if (i > 0) continue;
    const bool kind = is_held_out(last);
    for (size_t row = 0; row < likely.size(); ++row)
      if (is_held_out_[row] != kind) likely[row] = 0;
  }
  return draws;
}

void RowSampler::told(int64_t row, double cost) {
  double& known = costs_[static_cast<size_t>(row)];
  known = known > 0 ? known + kRecent * (cost - known) : cost;
}

std::vector<double*> RowSampler::state() {
  std::vector<double*> all;
  for (double& cost : costs_) all.push_back(&cost);
  return all;
}

bool RowSampler::is_held_out(int64_t row) const {
  return is_held_out_[static_cast<size_t>(row)];
}

int64_t RowSampler::first_of(int64_t row) const {
  return firsts_[static_cast<size_t>(row)];
}

}  // namespace engram::training
