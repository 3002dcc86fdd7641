// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/redundancy_policy.h"

#include <algorithm>

namespace engram::ltm {

Result<std::unique_ptr<RedundancyPolicy>> RedundancyPolicy::create(
    const SimilarityFilter::Options& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  return std::unique_ptr<RedundancyPolicy>(new RedundancyPolicy(options));
}

Result<std::vector<ForgetProposal>> RedundancyPolicy::propose(ForgetSource& source,
                                                              const ForgetView& view) {
  std::vector<ForgetProposal> proposals;
  const auto& may_go = view.may_go;
  const auto first = std::ranges::find(may_go, true);
  if (first == may_go.end()) return proposals;
  const auto last = std::find(may_go.rbegin(), may_go.rend(), true).base();
  const idf::Type* type = source.store().manifest().types.of_entity(view.entity);
  ENGRAM_ASSIGN_OR_RETURN(SimilarityFilter filter, SimilarityFilter::create(options_));
  // One before, if there is one: it stays, and may be what the first is similar to.
  const auto begin = first == may_go.begin() ? first : std::prev(first);
  for (auto i = static_cast<size_t>(begin - may_go.begin());
       i < static_cast<size_t>(last - may_go.begin()); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(Snapshot snapshot, source.read(view.entity, view.snapshots[i]));
    Candidate candidate{std::move(snapshot), 0, 0, {}};
    if (type != nullptr) candidate.type = *type;
    FilterDecisions decisions;
    filter.offer(std::move(candidate), decisions);
    if (may_go[i] && !decisions.dropped.empty())
      proposals.push_back({i, static_cast<double>(to_ns(view.snapshots[i].time))});
  }
  return proposals;
}

}  // namespace engram::ltm
