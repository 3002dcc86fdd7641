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

/// What of some entities may go: what all its policies propose, in the order of the last one.
struct ForgetRule {
  EntityPattern match;
  std::optional<AgePolicy::Options> age;
  std::optional<UnreadPolicy::Options> access;
  std::optional<ImportancePolicy::Options> importance;
  std::optional<SimilarityFilter::Options> redundancy;

  /// Errors: kInvalidArgument; one policy at least is needed.
  [[nodiscard]] Status validate() const;

  /// In the order in which they are asked, the cheapest first.
  /// Errors: those of validate.
  Result<std::vector<std::unique_ptr<ForgetPolicy>>> policies(Time now) const;
};

/// What never goes by a rule or a quota.
struct ForgetProtection {
  std::vector<EntityPattern> entities;
  /// That many of each entity, the newest; those that are not sealed yet count.
  uint64_t newest = 1;
  /// Snapshots less than this before now.
  std::optional<Duration> younger_than;
  /// Snapshots that are named in the data of others that stay. Costs a read of all that stays.
  bool linked = false;
};

/// What a store is to forget.
/// Source: docs/forgetting.md.
struct ForgetOptions {
  /// Each sees what those before it leave.
  std::vector<ForgetRule> rules;

  /// Most bytes of the store's directory.
  std::optional<uint64_t> max_bytes;
  /// Least bytes that are free on its disk.
  std::optional<uint64_t> min_free_disk_bytes;
  /// What goes first where these demand more than the rules take: all that the first rule proposes,
  /// in its order, then the second, and so on; at last whatever is oldest.
  std::vector<ForgetRule> first;

  ForgetProtection protection;

  [[nodiscard]] Status validate() const;
};

}  // namespace engram::ltm
