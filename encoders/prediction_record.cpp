// SPDX-License-Identifier: Apache-2.0
#include "encoders/prediction_record.h"

#include <algorithm>

namespace engram::encoders {

ltm::ErrorEstimate PredictionRecord::estimate(const ltm::MeasuredError& change, int steps) const {
  const HorizonErrors& horizon =
      errors[static_cast<size_t>(std::clamp(steps, 1, kMeasuredHorizons) - 1)];
  ltm::ErrorEstimate estimate;
  estimate.expected = {horizon.images.expected(change.image_mse),
                       horizon.numbers.expected(change.number_mse)};
  if (steps <= kMeasuredHorizons)
    // The order of the arguments keeps NaN, which is a bound that is not known.
    estimate.bound = {std::min(horizon.images.bound(change.image_mse), kMaxImageMse),
                      horizon.numbers.bound(change.number_mse)};
  return estimate;
}

std::vector<ltm::HorizonRecord> PredictionRecord::horizons() const {
  std::vector<ltm::HorizonRecord> records;
  for (size_t i = 0; i < errors.size(); ++i) {
    const auto& [images, numbers] = errors[i];
    const int64_t measured = std::max(images.measured, numbers.measured);
    if (measured == 0) continue;
    records.push_back(
        {static_cast<int>(i + 1), static_cast<uint64_t>(measured), {images.mean, numbers.mean}});
  }
  return records;
}

}  // namespace engram::encoders
