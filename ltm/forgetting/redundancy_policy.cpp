// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/redundancy_policy.h"

namespace engram::ltm {

Result<std::unique_ptr<RedundancyPolicy>> RedundancyPolicy::create(
    const SimilarityFilter::Options& options) {
  ENGRAM_ASSIGN_OR_RETURN(SimilarityFilter filter, SimilarityFilter::create(options));
  return std::unique_ptr<RedundancyPolicy>(new RedundancyPolicy(std::move(filter)));
}

Result<bool> RedundancyPolicy::offer(ForgetSource& source, const MemoryId& entity,
                                     const SnapshotEntry& entry) {
  ENGRAM_ASSIGN_OR_RETURN(Snapshot snapshot, source.read(entity, entry));
  Candidate candidate{std::move(snapshot), 0, 0, {}};
  const idf::Type* type = source.store().manifest().types.of_entity(entity);
  if (type != nullptr) candidate.type = *type;
  FilterDecisions decisions;
  filter_.offer(std::move(candidate), decisions);
  return !decisions.dropped.empty();
}

Result<std::vector<ForgetProposal>> RedundancyPolicy::propose(ForgetSource& source,
                                                              const ForgetView& view) {
  std::vector<ForgetProposal> proposals;
  for (size_t i = 0; i < view.snapshots.size(); ++i) {
    const SnapshotEntry& entry = view.snapshots[i];
    if (!view.may_go[i]) {
      // Before the first snapshot that may go, only its neighbour is needed: the filter compares
      // with that, and reading the others would cost much.
      if (!has_begun_) staying_.clear();
      staying_.push_back(entry);
      continue;
    }
    has_begun_ = true;
    for (const SnapshotEntry& stays : staying_)
      ENGRAM_RETURN_IF_ERROR(offer(source, view.entity, stays).status());
    staying_.clear();
    ENGRAM_ASSIGN_OR_RETURN(const bool is_similar, offer(source, view.entity, entry));
    if (is_similar) proposals.push_back({i, static_cast<double>(to_ns(entry.time))});
  }
  return proposals;
}

}  // namespace engram::ltm
