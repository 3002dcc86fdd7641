// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ltm/filter/entity_pattern.h"
#include "ltm/forgetting/forget_policy.h"

namespace engram::ltm {

/// Proposes the least salient snapshots, the least salient first.
///
/// A snapshot without a saliency is never proposed: no night has looked at it yet.
/// Complexity: O(log N) for each snapshot, once the saliency of the store was read.
/// Source: docs/saliency.md.
class SaliencyPolicy final : public ForgetPolicy {
 public:
  struct Options {
    /// Snapshots with less than this are proposed, 0 to 1. Empty: all are, or as `keep` says.
    std::optional<double> below;
    /// The share that stays of all snapshots that have a saliency and are of entities that the rule
    /// matches, 0 to 1: the most salient ones, wherever they are. Empty: no such condition.
    std::optional<double> keep;

    [[nodiscard]] Status validate() const;
  };

  /// `match` are the entities of which `keep` is a share.
  SaliencyPolicy(const Options& options, EntityPattern match)
      : options_(options), match_(std::move(match)) {}

  [[nodiscard]] std::string reason() const override;
  Result<std::vector<ForgetProposal>> propose(ForgetSource& source,
                                              const ForgetView& view) override;

 private:
  Options options_;
  EntityPattern match_;
};

}  // namespace engram::ltm
