// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/frequency_filter.h"

#include <cmath>

#include "ltm/filter/saturated_time.h"

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

void FrequencyFilter::offer(Candidate candidate, FilterDecisions& decisions) {
  if (is_due(candidate.snapshot.time))
    decisions.keep(std::move(candidate));
  else
    decisions.drop("rate", candidate);
}

bool FrequencyFilter::is_due(Time time) {
  // The tolerance takes cameras that jitter around their period.
  if (next_ && time < saturated_add(*next_, -period_ / 10)) return false;
  const bool is_on_grid = next_ && time < saturated_add(*next_, period_);
  next_ = saturated_add(is_on_grid ? *next_ : time, period_);
  return true;
}

}  // namespace engram::ltm
