// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ltm/filter/entity_pattern.h"
#include "ltm/forgetting/age_policy.h"
#include "ltm/forgetting/importance_policy.h"
#include "ltm/forgetting/redundancy_policy.h"
#include "ltm/forgetting/saliency_policy.h"
#include "ltm/forgetting/unread_policy.h"

namespace engram::ltm {

/// Selects snapshots of some entities that may be forgotten: those that all its policies propose,
/// in the order of the last policy.
struct ForgetRule {
  EntityPattern match;
  std::optional<AgePolicy::Options> age;
  std::optional<UnreadPolicy::Options> access;
  std::optional<ImportancePolicy::Options> importance;
  std::optional<SaliencyPolicy::Options> saliency;
  std::optional<SimilarityFilter::Options> redundancy;

  [[nodiscard]] bool has_policy() const {
    return age || access || importance || saliency || redundancy;
  }
  /// Errors: kInvalidArgument, also if there is no policy.
  [[nodiscard]] Status validate() const;

  /// Makes the policies in the order in which they are asked, the cheapest first.
  /// Errors: those of validate.
  Result<std::vector<std::unique_ptr<ForgetPolicy>>> policies(Time now) const;
};

/// One step of fading: which snapshots fade, and how far. A snapshot that several steps take fades
/// as far as the furthest of them.
struct FadeStep {
  ForgetRule rule;
  /// Min PSNR of every image against what was recorded. Without it a gist is what remains.
  /// Unit: dB.
  std::optional<double> psnr_db;

  static constexpr double kMinPsnrDb = 15;
  static constexpr double kMaxPsnrDb = 60;

  /// "to 32 dB" or "to a gist".
  [[nodiscard]] std::string text() const;
  /// Whether it leaves less than another one.
  [[nodiscard]] bool is_further_than(const FadeStep& other) const {
    return psnr_db.value_or(0) < other.psnr_db.value_or(0);
  }
  /// Errors: kInvalidArgument.
  [[nodiscard]] Status validate() const;
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

  /// What fades of the snapshots that the rules leave.
  std::vector<FadeStep> fade;
  static constexpr size_t kMaxFadeSteps = 64;

  /// Max bytes of the store's directory.
  std::optional<uint64_t> max_bytes;
  /// Min free bytes on its disk.
  std::optional<uint64_t> min_free_disk_bytes;
  /// The order in which snapshots go if these quotas demand more than the rules take and fading
  /// gives: first all that the first rule here proposes, in its order, then the second, and so on.
  /// At last the oldest go.
  std::vector<ForgetRule> first;

  ForgetProtection protection;

  /// Whether these are of a round after another one (quota_after). Then only a quota makes
  /// snapshots fade, in the order of the steps and whatever their age.
  bool is_later_round = false;

  [[nodiscard]] Status validate() const;
};

}  // namespace engram::ltm
