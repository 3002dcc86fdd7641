// SPDX-License-Identifier: Apache-2.0
#include "training/fit/row_sampler.h"

#include <algorithm>
#include <numeric>

#include "encoders/torch.h"

namespace engram::training {

namespace {

/// Share of the draws with equal probabilities. It bounds weights to its inverse.
constexpr double kEqualShare = 0.5;
constexpr double kRecent = 0.3;
/// Max share of the mean of rows that the previous model knows.
constexpr double kReplayShare = 0.3;

/// The share of each row in the mean. Rows count equally, but known ones together no more than
/// kReplayShare.
std::vector<double> shares_of(size_t rows, const std::vector<bool>& is_known) {
  const auto all = static_cast<double>(rows);
  const auto known = static_cast<double>(std::ranges::count(is_known, true));
  if (known <= kReplayShare * all || known == all) return std::vector<double>(rows, 1.0 / all);
  std::vector<double> shares;
  for (const bool is : is_known)
    shares.push_back(is ? kReplayShare / known : (1 - kReplayShare) / (all - known));
  return shares;
}

/// Draws an index: the first one whose cumulative probability is above a random number.
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

RowSampler::RowSampler(std::span<const Sequence> sequences, std::span<const size_t> first_held_out,
                       const std::vector<bool>& is_known) {
  for (size_t s = 0; s < sequences.size(); ++s)
    for (size_t row = sequences[s].first; row < sequences[s].end; ++row) {
      firsts_.push_back(static_cast<int64_t>(sequences[s].first));
      is_held_out_.push_back(row >= first_held_out[s]);
    }
  shares_ = shares_of(firsts_.size(), is_known);
  costs_.assign(firsts_.size(), 0.0);
}

std::vector<double> RowSampler::probabilities() const {
  const double told =
      static_cast<double>(std::ranges::count_if(costs_, [](double cost) { return cost > 0; }));
  const double sum = std::reduce(costs_.begin(), costs_.end());
  // Rows with unknown costs count as average ones.
  const double usual = told > 0 ? sum / told : 1.0;
  std::vector<double> by_cost;
  for (size_t row = 0; row < costs_.size(); ++row)
    by_cost.push_back(shares_[row] * (costs_[row] > 0 ? costs_[row] : usual));
  const double total = std::reduce(by_cost.begin(), by_cost.end());
  std::vector<double> result;
  for (size_t row = 0; row < costs_.size(); ++row)
    result.push_back(kEqualShare * shares_[row] + (1 - kEqualShare) * by_cost[row] / total);
  return result;
}

std::vector<RowSampler::Draw> RowSampler::draw(int64_t chunks) {
  const std::vector<double> probability = probabilities();
  std::vector<double> likely = probability;
  std::vector<Draw> draws;
  for (int64_t i = 0; i < chunks; ++i) {
    const int64_t last = drawn(likely);
    // Probabilities keep their ratios among rows of one kind, so over all batches a row is drawn as
    // often as without the separation.
    const auto at = static_cast<size_t>(last);
    draws.push_back({last, shares_[at] / probability[at]});
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

void RowSampler::forget(const Sequence& rows) {
  std::fill(costs_.begin() + static_cast<ptrdiff_t>(rows.first),
            costs_.begin() + static_cast<ptrdiff_t>(rows.end), 0.0);
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
