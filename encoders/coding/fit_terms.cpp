// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>

#include "encoders/coding/number_fit.h"

namespace engram::encoders {

namespace {

/// Max distance of channels that may predict each other, which keeps the search fast for many
/// numbers.
constexpr size_t kMaxDistance = 64;
/// Ridge, in squared steps.
constexpr double kRidge = 4.0;
constexpr int kReweightings = 4;
constexpr double kLargestWeight = 7.9;

struct Candidate {
  PredictorTerm term;
  std::vector<double> values;
};

std::vector<NumberKind> kinds_of(const NumberModel& model) {
  std::vector<NumberKind> kinds;
  for (const NumberField& field : model.fields)
    kinds.insert(kinds.end(), field.kind == NumberKind::kOrientation ? 3 : field.count, field.kind);
  return kinds;
}

std::vector<double> bounds_of(const NumberModel& model) {
  std::vector<double> bounds;
  for (const NumberField& field : model.fields)
    bounds.insert(bounds.end(), field.kind == NumberKind::kOrientation ? 3 : field.count,
                  field.kind == NumberKind::kBounded ? field.bound : 0.0);
  return bounds;
}

double value_of(const PredictorTerm& term, size_t channel, const ChannelRows& rows, size_t t) {
  const auto& now = rows.coded[t];
  const auto& last = rows.coded[t - 1];
  const auto& before = rows.coded[t - 2];
  const auto& earlier = rows.coded[t - 3];
  const size_t from = term.channel;
  switch (term.kind) {
    case FeatureKind::kChange:
      return last[from] - before[from];
    case FeatureKind::kChangeBefore:
      return before[from] - earlier[from];
    case FeatureKind::kChangeNow:
      return now[from] - last[from];
    case FeatureKind::kLevelNow:
      return now[from] - last[channel];
    case FeatureKind::kLevel:
      return last[from] - last[channel];
  }
  return 0;
}

bool may_help(const std::vector<double>& bounds, const PredictorTerm& term, size_t channel) {
  const size_t from = term.channel;
  const bool is_now = term.kind == FeatureKind::kChangeNow || term.kind == FeatureKind::kLevelNow;
  if (is_now && from >= channel) return false;
  if (bounds[from] != bounds[channel]) return false;
  const bool is_level = term.kind == FeatureKind::kLevel || term.kind == FeatureKind::kLevelNow;
  return !(is_level && from == channel);
}

class TermSearch {
 public:
  TermSearch(const NumberModel& model, size_t channel, std::span<const ChannelRows> recordings)
      : channel_(channel), recordings_(recordings) {
    collect_target();
    const std::vector<double> bounds = bounds_of(model);
    const size_t first = channel - std::min(channel, kMaxDistance);
    const size_t end = std::min(model.channels.size(), channel + kMaxDistance + 1);
    for (size_t kind = 0; kind < kFeatureKinds; ++kind)
      for (size_t from = first; from < end; ++from) {
        const PredictorTerm term{static_cast<FeatureKind>(kind), static_cast<uint16_t>(from), 0};
        if (may_help(bounds, term, channel)) add_candidate(term);
      }
    residual_ = target_;
  }

  std::vector<PredictorTerm> run(size_t max_terms, double min_gain_bits) {
    while (chosen_.size() < max_terms) {
      const double before = mean_size();
      const auto best = best_candidate();
      if (!best) break;
      chosen_.push_back(*best);
      const auto kept_weights = weights_;
      const auto kept_residual = residual_;
      refit();
      const double gain =
          static_cast<double>(target_.size()) * std::log2((before + 0.2) / (mean_size() + 0.2));
      if (gain >= min_gain_bits) continue;
      chosen_.pop_back();
      weights_ = kept_weights;
      residual_ = kept_residual;
      break;
    }
    return terms();
  }

 private:
  void collect_target() {
    for (const ChannelRows& rows : recordings_)
      for (size_t t = 3; t < rows.coded.size(); ++t)
        target_.push_back(rows.real[t][channel_] - rows.coded[t - 1][channel_]);
  }

  void add_candidate(const PredictorTerm& term) {
    Candidate candidate{term, {}};
    for (const ChannelRows& rows : recordings_)
      for (size_t t = 3; t < rows.coded.size(); ++t)
        candidate.values.push_back(value_of(term, channel_, rows, t));
    candidates_.push_back(std::move(candidate));
  }

  /// Weights of reweighted least squares, which minimise sizes of residuals instead of squares:
  /// code length follows sizes.
  [[nodiscard]] std::vector<double> row_weights() const {
    std::vector<double> result;
    result.reserve(residual_.size());
    for (const double r : residual_) result.push_back(1 / std::sqrt(r * r + 1));
    return result;
  }

  [[nodiscard]] double mean_size() const {
    double sum = 0;
    for (const double r : residual_) sum += std::abs(r);
    return residual_.empty() ? 0 : sum / static_cast<double>(residual_.size());
  }

  [[nodiscard]] std::optional<size_t> best_candidate() const {
    const std::vector<double> w = row_weights();
    double best = 0;
    std::optional<size_t> result;
    for (size_t i = 0; i < candidates_.size(); ++i) {
      const auto& f = candidates_[i].values;
      double fr = 0, ff = kRidge;
      for (size_t t = 0; t < f.size(); ++t) {
        fr += w[t] * f[t] * residual_[t];
        ff += w[t] * f[t] * f[t];
      }
      if (fr * fr / ff <= best || std::ranges::find(chosen_, i) != chosen_.end()) continue;
      best = fr * fr / ff;
      result = i;
    }
    return result;
  }

  void refit() {
    for (int i = 0; i < kReweightings; ++i) {
      solve(row_weights());
      residual_ = target_;
      for (size_t k = 0; k < chosen_.size(); ++k)
        for (size_t t = 0; t < target_.size(); ++t)
          residual_[t] -= weights_[k] * candidates_[chosen_[k]].values[t];
    }
  }

  /// Weighted least squares by Gaussian elimination; the matrix is positive definite.
  void solve(const std::vector<double>& w) {
    const size_t n = chosen_.size();
    std::vector<std::vector<double>> a(n, std::vector<double>(n + 1));
    for (size_t i = 0; i < n; ++i) {
      const auto& fi = candidates_[chosen_[i]].values;
      for (size_t k = 0; k < n; ++k) {
        const auto& fk = candidates_[chosen_[k]].values;
        for (size_t t = 0; t < w.size(); ++t) a[i][k] += w[t] * fi[t] * fk[t];
      }
      for (size_t t = 0; t < w.size(); ++t) a[i][n] += w[t] * fi[t] * target_[t];
      a[i][i] += kRidge;
    }
    for (size_t i = 0; i < n; ++i)
      for (size_t k = i + 1; k < n; ++k) {
        const double factor = a[k][i] / a[i][i];
        for (size_t m = i; m <= n; ++m) a[k][m] -= factor * a[i][m];
      }
    weights_.assign(n, 0);
    for (size_t i = n; i-- > 0;) {
      double sum = a[i][n];
      for (size_t k = i + 1; k < n; ++k) sum -= a[i][k] * weights_[k];
      weights_[i] = std::clamp(sum / a[i][i], -kLargestWeight, kLargestWeight);
    }
  }

  [[nodiscard]] std::vector<PredictorTerm> terms() const {
    std::vector<PredictorTerm> result;
    for (size_t i = 0; i < chosen_.size(); ++i) {
      result.push_back(candidates_[chosen_[i]].term);
      result.back().weight = static_cast<int16_t>(std::lround(weights_[i] * 4096));
    }
    return result;
  }

  size_t channel_;
  std::span<const ChannelRows> recordings_;
  std::vector<double> target_, residual_, weights_;
  std::vector<Candidate> candidates_;
  std::vector<size_t> chosen_;
};

}  // namespace

std::vector<PredictorTerm> fit_terms(const NumberModel& model, size_t channel,
                                     std::span<const ChannelRows> recordings,
                                     const NumberTraining& options) {
  if (kinds_of(model)[channel] == NumberKind::kOrientation) return {};
  return TermSearch(model, channel, recordings)
      .run(std::min(options.max_terms, NumberChannel::kMaxTerms), options.min_gain_bits);
}

}  // namespace engram::encoders
