// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/age_policy.h"

#include "ltm/filter/saturated_time.h"

namespace engram::ltm {

Status AgePolicy::Options::validate() const {
  if (!older_than || *older_than >= Duration(0)) return {};
  return invalid_argument("older_than: found {}, needs 0s or more", to_string(*older_than));
}

std::string AgePolicy::reason() const {
  return options_.older_than ? "older than " + to_string(*options_.older_than) : "oldest";
}

Result<std::vector<ForgetProposal>> AgePolicy::propose(ForgetSource&, const ForgetView& view) {
  const Time end = options_.older_than ? saturated_add(now_, -*options_.older_than) : Time::max();
  std::vector<ForgetProposal> proposals;
  for (size_t i = 0; i < view.snapshots.size(); ++i) {
    const Time time = view.snapshots[i].time;
    const bool is_old = !options_.older_than || time < end;
    if (view.may_go[i] && is_old) proposals.push_back({i, static_cast<double>(to_ns(time))});
  }
  return proposals;
}

}  // namespace engram::ltm
