// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "ltm/filter/entity_pattern.h"
#include "ltm/forgetting/age_policy.h"
#include "ltm/forgetting/importance_policy.h"
#include "ltm/forgetting/redundancy_policy.h"
#include "ltm/forgetting/unread_policy.h"

namespace engram::ltm {

/// Selects snapshots of some entities that may be forgotten: those that all its policies propose,
/// in the order of the last policy.
struct ForgetRule {
  EntityPattern match;
  std::optional<AgePolicy::Options> age;
  std::optional<UnreadPolicy::Options> access;
  std::optional<ImportancePolicy::Options> importance;
  std::optional<SimilarityFilter::Options> redundancy;

  /// Errors: kInvalidArgument, also if there is no policy.
  [[nodiscard]] Status validate() const;

  /// Makes the policies in the order in which they are asked, the cheapest first.
  /// Errors: those of validate.
  Result<std::vector<std::unique_ptr<ForgetPolicy>>> policies(Time now) const;
};

/// Snapshots that no rule or quota may take.
struct ForgetProtection {
  std::vector<EntityPattern> entities;
  /// Number of newest snapshots of each entity, including those that are not sealed yet.
  uint64_t newest = 1;
  /// Snapshots younger than this.
  std::optional<Duration> younger_than;
  /// If true, snapshots that the data of staying snapshots link to. It costs a read of all
  /// snapshots that stay.
  bool linked = false;
};

/// Defines what a store is to forget.
/// Source: docs/forgetting.md.
struct ForgetOptions {
  /// Each rule sees what those before it leave.
  std::vector<ForgetRule> rules;

  /// Max bytes of the store's directory.
  std::optional<uint64_t> max_bytes;
  /// Min free bytes on its disk.
  std::optional<uint64_t> min_free_disk_bytes;
  /// The order in which snapshots go if these quotas demand more than the rules take: first all
  /// that the first rule here proposes, in its order, then the second, and so on. At last the
  /// oldest go.
  std::vector<ForgetRule> first;

  ForgetProtection protection;

  [[nodiscard]] Status validate() const;
};

}  // namespace engram::ltm
