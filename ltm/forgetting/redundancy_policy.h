// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/filter/similarity_filter.h"
#include "ltm/forgetting/forget_policy.h"

namespace engram::ltm {

/// Proposes near-duplicates, the older first: snapshots that are similar in every member to the
/// last one that stays. At least one stays every `max_gap`.
///
/// Complexity: decodes every snapshot between the first and the last that may go.
class RedundancyPolicy final : public ForgetPolicy {
 public:
  /// Errors: kInvalidArgument if the options do not validate.
  static Result<std::unique_ptr<RedundancyPolicy>> create(const SimilarityFilter::Options& options);

  [[nodiscard]] std::string reason() const override { return "redundant"; }
  Result<std::vector<ForgetProposal>> propose(ForgetSource& source,
                                              const ForgetView& view) override;

 private:
  explicit RedundancyPolicy(SimilarityFilter filter) : filter_(std::move(filter)) {}

  /// True if the snapshot is similar to the last one that the filter kept.
  Result<bool> offer(ForgetSource& source, const MemoryId& entity, const SnapshotEntry& entry);

  SimilarityFilter filter_;
  bool has_begun_ = false;
  /// Snapshots that must stay and come after the last one that may go.
  std::vector<SnapshotEntry> staying_;
};

}  // namespace engram::ltm
