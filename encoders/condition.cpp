// SPDX-License-Identifier: Apache-2.0
#include "encoders/condition.h"

#include <algorithm>
#include <cmath>

namespace engram::encoders {

namespace {

/// Max magnitude of a normalised number, in deviations.
constexpr double kMax = 1e4;

}  // namespace

Result<torch::Tensor> Condition::read(const idf::Data& value) const {
  ENGRAM_ASSIGN_OR_RETURN(const auto split, plan.layout().split(value));
  return torch::tensor(normalised(plan.read_numbers(split), mean, deviation)).unsqueeze(0);
}

std::vector<float> normalised(std::span<const double> numbers, std::span<const double> mean,
                              std::span<const double> deviation) {
  std::vector<float> result;
  for (size_t i = 0; i < numbers.size(); ++i) {
    const double x = deviation[i] > 0 ? (numbers[i] - mean[i]) / deviation[i] : 0.0;
    result.push_back(std::isfinite(x) ? static_cast<float>(std::clamp(x, -kMax, kMax)) : 0.0F);
  }
  return result;
}

}  // namespace engram::encoders
