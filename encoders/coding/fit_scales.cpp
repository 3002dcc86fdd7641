// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "encoders/coding/number_fit.h"

namespace engram::encoders {

namespace {

constexpr size_t kMaxSamples = 20000;
constexpr int kFitSteps = 300;
constexpr double kRate = 0.02;

double share_beyond(double z) {
  return 0.875 / (1 + std::exp(z)) + 0.125 / (1 + std::exp(z / 4));
}

/// Cost of a residual under an estimate. Unit: bits. `log_scale` is ln of the scale in steps.
double cost(const ResidualTrace& sample, size_t estimate, double log_scale) {
  const double inverse = std::exp(-log_scale);
  const double distance =
      static_cast<double>(sample.residual) - static_cast<double>(sample.offset[estimate]) / 16;
  const double share =
      share_beyond((distance - 0.5) * inverse) - share_beyond((distance + 0.5) * inverse);
  return -std::log2(std::max(share, 1e-9));
}

/// The optimiser Adam for one vector of parameters.
class Adam {
 public:
  explicit Adam(size_t count) : mean_(count), square_(count) {}

  void step(std::vector<double>& parameters, const std::vector<double>& gradient) {
    for (size_t i = 0; i < parameters.size(); ++i) {
      mean_[i] = 0.9 * mean_[i] + 0.1 * gradient[i];
      square_[i] = 0.99 * square_[i] + 0.01 * gradient[i] * gradient[i];
      parameters[i] -= kRate * mean_[i] / (std::sqrt(square_[i]) + 1e-9);
    }
  }

 private:
  std::vector<double> mean_, square_;
};

constexpr double kNatsPerSixteenth = 0.6931471805599453 / 16;

double log_scale_of(const ResidualTrace& sample, const std::vector<double>& parameters) {
  double sum = parameters[kScaleInputs + sample.channel];
  for (size_t i = 0; i < kScaleInputs; ++i)
    sum += parameters[i] * sample.sizes[i] * kNatsPerSixteenth;
  return std::clamp(sum, -2.7, 13.0);
}

std::vector<double> descend(const std::vector<ResidualTrace>& samples, size_t channels) {
  std::vector<double> parameters(kScaleInputs + channels, -0.3);
  const std::array<double, kScaleInputs> start{0.3, 0.3, 0.1, 0.1, 0.0, 0.1};
  std::ranges::copy(start, parameters.begin());
  Adam adam(parameters.size());
  for (int step = 0; step < kFitSteps; ++step) {
    std::vector<double> gradient(parameters.size());
    for (const ResidualTrace& sample : samples) {
      const double scale = log_scale_of(sample, parameters);
      const double slope = (cost(sample, 0, scale + 1e-3) - cost(sample, 0, scale - 1e-3)) / 2e-3 /
                           static_cast<double>(samples.size());
      gradient[kScaleInputs + sample.channel] += slope;
      for (size_t i = 0; i < kScaleInputs; ++i)
        gradient[i] += slope * sample.sizes[i] * kNatsPerSixteenth;
    }
    adam.step(parameters, gradient);
  }
  return parameters;
}

/// The correction with the lowest cost for one estimate of one channel. Unit: 1/16 of an octave.
int8_t best_bias(const std::vector<const ResidualTrace*>& samples, size_t estimate,
                 const std::vector<double>& parameters) {
  int best = 0;
  double min = INFINITY;
  for (int bias = -32; bias <= 64; bias += 4) {
    double sum = 0;
    for (const ResidualTrace* sample : samples)
      sum += cost(*sample, estimate, log_scale_of(*sample, parameters) + bias * kNatsPerSixteenth);
    if (sum >= min) continue;
    min = sum;
    best = bias;
  }
  return static_cast<int8_t>(best);
}

}  // namespace

void fit_scales(std::span<const ResidualTrace> trace, NumberModel& model) {
  std::vector<ResidualTrace> samples;
  const size_t stride = trace.size() / kMaxSamples + 1;
  for (size_t i = 0; i < trace.size(); i += stride)
    if (!trace[i].is_first) samples.push_back(trace[i]);
  if (samples.empty()) return;
  const std::vector<double> parameters = descend(samples, model.channels.size());
  for (size_t i = 0; i < kScaleInputs; ++i)
    model.scale_weights[i] =
        static_cast<int16_t>(std::lround(std::clamp(parameters[i], -8.0, 8.0) * 256));
  std::vector<std::vector<const ResidualTrace*>> by_channel(model.channels.size());
  for (const ResidualTrace& sample : samples) by_channel[sample.channel].push_back(&sample);
  for (size_t c = 0; c < model.channels.size(); ++c) {
    const double own = parameters[kScaleInputs + c] / kNatsPerSixteenth;
    for (size_t i = 0; i < kEstimates; ++i) {
      const int bias = i == 0 ? 0 : best_bias(by_channel[c], i, parameters);
      model.channels[c].scale_bias[i] =
          static_cast<int8_t>(std::clamp(std::lround(own) + bias, -127L, 127L));
    }
  }
}

}  // namespace engram::encoders
