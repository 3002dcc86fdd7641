// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/frequency_filter.h"

#include <cmath>

#include "ltm/filter/saturated_time.h"

namespace engram::ltm {

namespace {

constexpr std::string_view kReason = "rate";

}  // namespace

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
    decisions.drop(kReason, candidate);
}

std::optional<std::string_view> FrequencyFilter::drops_at(Time time) const {
  // Cameras jitter around their period. Without the tolerance every early image would be dropped.
  const bool is_early = next_ && time < saturated_add(*next_, -period_ / 10);
  return is_early ? std::optional(kReason) : std::nullopt;
}

bool FrequencyFilter::is_due(Time time) {
  if (drops_at(time)) return false;
  const bool is_on_grid = next_ && time < saturated_add(*next_, period_);
  next_ = saturated_add(is_on_grid ? *next_ : time, period_);
  return true;
}

}  // namespace engram::ltm
