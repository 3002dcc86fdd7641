// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/equality_filter.h"

#include <algorithm>

#include "ltm/filter/saturated_time.h"

namespace engram::ltm {

Status EqualityFilter::Options::validate() const {
  if (max_gap && *max_gap <= Duration(0))
    return invalid_argument("equality filter: max_gap is {}, needs more than 0s",
                            to_string(*max_gap));
  return {};
}

Result<EqualityFilter> EqualityFilter::create(const Options& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  return EqualityFilter(options);
}

void EqualityFilter::offer(Candidate candidate, FilterDecisions& decisions) {
  const Snapshot& now = candidate.snapshot;
  const bool is_gap =
      last_ && options_.max_gap && now.time >= saturated_add(last_->time, *options_.max_gap);
  const bool is_equal = last_ && std::ranges::equal(now.instances, last_->instances, {},
                                                    &Instance::data, &Instance::data);
  if (is_equal && !is_gap) return decisions.drop("equal", candidate);
  last_ = now;
  decisions.keep(std::move(candidate));
}

}  // namespace engram::ltm
