// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "ltm/forgetting/freed_bytes.h"
#include "ltm/forgetting/plan_forgetting.h"

namespace engram::ltm {

/// Makes a plan in steps. Each step takes snapshots or protects some from being taken.
///
/// Threading: one thread.
class ForgetPlanner {
 public:
  /// All arguments must outlive this.
  ForgetPlanner(ForgetSource& source, const ForgetProtection& protection,
                const ForgetContext& context)
      : source_(source), protection_(protection), context_(context) {}

  /// Lists all snapshots. With `is_explicit` new snapshots are not protected.
  Status load(bool is_explicit);

  /// Takes the snapshots that a rule proposes.
  Status take_by(const ForgetRule& rule);

  /// Takes the chosen snapshots.
  Status take(const ForgetSet& chosen, const std::string& reason);

  /// Gives back the snapshots that staying ones link to, and protects them from later steps.
  Status protect_linked();

  /// Makes those staying snapshots fade that the steps of fading propose, if they do so by rule.
  Status fade_by(const ForgetOptions& options);

  /// Makes more snapshots fade, step by step and whatever their age, until by what is
  /// expected the quotas are met.
  Status fade_for_quota(const ForgetOptions& options);

  /// Takes more snapshots until, by what is expected, the quotas are met. It takes none if some
  /// fade for a quota, because only then is it known how much is missing.
  Status take_for_quota(const ForgetOptions& options);

  [[nodiscard]] ForgetPlan finish();

 private:
  static constexpr uint16_t kStays = 0;

  /// What fading does to one snapshot.
  struct Faded {
    uint16_t reason = kStays;  ///< kStays if it does not fade.
    uint8_t step = 0;          ///< Index into steps_.
    float bytes = 0;           ///< What that frees, an estimate.
  };

  /// The snapshots of one entity, sorted by time. It keeps few bytes of each, because a store may
  /// have ten million.
  struct Entity {
    MemoryId id;
    std::vector<Time> times;
    std::vector<SnapshotPlaces> places;
    std::vector<bool> is_protected;
    std::vector<uint16_t> reason;  ///< Per snapshot, kStays or an index into reasons_.
    std::vector<Faded> fading;     ///< Per snapshot; empty if no step of fading was asked.
    uint64_t unsealed = 0;
    uint64_t shielded = 0;
  };

  /// A snapshot that a quota may take.
  struct Candidate {
    double order = 0;
    uint32_t entity = 0;
    uint32_t snapshot = 0;
  };

  /// Asks a rule which snapshots of an entity may go, and calls `take` with their indices and
  /// order. The rule does not see snapshots that are taken or queued (`is_queued`).
  Status ask(const ForgetRule& rule, const Entity& entity, const std::vector<bool>& is_queued,
             const std::function<void(const ForgetProposal&)>& take);

  /// The number of the reason that plans state for a rule.
  Result<uint16_t> reason_of(const ForgetRule& rule, const std::string& prefix);

  static Result<std::vector<ForgetProposal>> propose(
      ForgetSource& source, const std::vector<std::unique_ptr<ForgetPolicy>>& policies,
      const MemoryId& id, std::span<const SnapshotEntry> snapshots, std::vector<bool> allowed);

  Status check_stop(const std::string& what, size_t done);
  uint16_t reason_number(const std::string& reason);
  [[nodiscard]] bool may_go(const Entity& entity, size_t snapshot) const;
  [[nodiscard]] uint64_t wanted_bytes(const ForgetOptions& options) const;
  Result<std::vector<Candidate>> candidates_of(const ForgetRule& rule,
                                               std::vector<std::vector<bool>>& is_queued);
  /// Lets a snapshot fade by a step, unless that gains nothing or another one goes further.
  Status fade(Entity& entity, size_t snapshot, size_t step, uint16_t reason);
  /// Lets what the policies of a step propose of an entity fade.
  Status fade_entity(Entity& entity, size_t step);
  /// What a quota counts of the bytes that go, and of those that fading frees.
  [[nodiscard]] static uint64_t counted_bytes(const FreedBytes& going,
                                              const ForgetOptions& options);
  [[nodiscard]] double counted_faded_bytes(const ForgetOptions& options) const;
  Status follow_links(std::vector<std::pair<size_t, size_t>>& waiting);
  Result<SnapshotEntry> entry(const Entity& entity, size_t snapshot);
  bool has_groups(uint32_t segment, const MemoryId& entity);
  [[nodiscard]] FreedBytes freed();
  [[nodiscard]] uint64_t freed_model_bytes(const Entity& entity) const;
  void add_fading(const Entity& entity, EntityForgetPlan& plan) const;
  [[nodiscard]] EntityForgetPlan plan_of(const Entity& entity, const FreedBytes& shares) const;

  ForgetSource& source_;
  const ForgetProtection& protection_;
  const ForgetContext& context_;
  std::vector<Entity> entities_;  ///< Sorted by ID.
  std::vector<std::string> reasons_{"stays"};
  std::map<std::pair<uint32_t, MemoryId>, bool> has_groups_;  ///< Cache of has_groups().
  std::vector<FadeStep> steps_;
  double faded_bytes_ = 0;  ///< An estimate of what fading frees.
  bool fades_for_quota_ = false;
  uint64_t missing_bytes_ = 0;
};

}  // namespace engram::ltm
