// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/frequency_filter.h"

#include <cmath>

namespace engram::ltm {

Status FrequencyFilter::Options::validate() const {
  if (!std::isfinite(max_rate_hz) || max_rate_hz < 1e-6 || max_rate_hz > 1e9)
    return invalid_argument("frequency filter: found {} Hz, needs 1e-6 to 1e9", max_rate_hz);
  return {};
}

Result<FrequencyFilter> FrequencyFilter::create(const Options& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  ENGRAM_ASSIGN_OR_RETURN(const Duration period, duration_from_seconds(1 / options.max_rate_hz));
  return FrequencyFilter(period);
}

bool FrequencyFilter::keeps(const Snapshot& snapshot) {
  // The tolerance takes cameras that jitter around their period.
  if (next_ && snapshot.time < *next_ - period_ / 10) return false;
  const bool is_on_grid = next_ && snapshot.time < *next_ + period_;
  next_ = (is_on_grid ? *next_ : snapshot.time) + period_;
  return true;
}

}  // namespace engram::ltm
