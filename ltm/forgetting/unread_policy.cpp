// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/unread_policy.h"

#include "ltm/filter/saturated_time.h"

namespace engram::ltm {

Status UnreadPolicy::Options::validate() const {
  if (unread_for && *unread_for < Duration(0))
    return invalid_argument("unread_for: found {}, needs 0s or more", to_string(*unread_for));
  if (read_less_than && *read_less_than == 0)
    return invalid_argument("read_less_than: found 0, needs 1 or more");
  return {};
}

std::string UnreadPolicy::reason() const {
  std::string text;
  if (options_.unread_for) text = "unread for " + to_string(*options_.unread_for);
  if (options_.read_less_than)
    text += fmt::format("{}read less than {} times", text.empty() ? "" : ", ",
                        *options_.read_less_than);
  return text.empty() ? "longest unread" : text;
}

Result<std::vector<ForgetProposal>> UnreadPolicy::propose(ForgetSource& source,
                                                          const ForgetView& view) {
  std::vector<ForgetProposal> proposals;
  for (size_t i = 0; i < view.snapshots.size(); ++i) {
    if (!view.may_go[i]) continue;
    const Time time = view.snapshots[i].time;
    const AccessStats stats = source.accesses(view.entity, time);
    const Time last = stats.count == 0 ? time : std::max(time, stats.last);
    if (options_.unread_for && last >= saturated_add(now_, -*options_.unread_for)) continue;
    if (options_.read_less_than && stats.count >= *options_.read_less_than) continue;
    proposals.push_back({i, static_cast<double>(to_ns(last))});
  }
  return proposals;
}

}  // namespace engram::ltm
