// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ltm/forgetting/freed_bytes.h"
#include "ltm/forgetting/plan_forgetting.h"

namespace engram::ltm {

/// The steps of a plan, each of which takes snapshots or keeps some from it.
///
/// Threading: one thread.
class ForgetPlanner {
 public:
  /// All outlive this.
  ForgetPlanner(ForgetSource& source, const ForgetProtection& protection,
                const ForgetContext& context)
      : source_(source), protection_(protection), context_(context) {}

  /// Lists all snapshots. `is_explicit`: what is new is not protected.
  Status load(bool is_explicit);

  /// Takes what a rule proposes.
  Status take_by(const ForgetRule& rule);

  /// Takes what was chosen.
  Status take(const ForgetSet& chosen, const std::string& reason);

  /// Gives back what is linked to from what stays, and protects it from here on.
  Status protect_linked();

  /// Takes more, until quotas are met as far as can be told.
  Status take_for_quota(const ForgetOptions& options);

  [[nodiscard]] ForgetPlan finish() const;

 private:
  static constexpr uint16_t kStays = 0;

  struct Entity {
    MemoryId id;
    const std::vector<SnapshotEntry>* snapshots = nullptr;
    std::vector<bool> is_protected;
    std::vector<uint16_t> reason;  ///< Per snapshot: kStays, or an index into reasons_.
    uint64_t unsealed = 0;
    uint64_t shielded = 0;
  };

  /// One that a quota may take.
  struct Candidate {
    size_t rank = 0;  ///< Of the rule that proposes it.
    double order = 0;
    Time time{};
    size_t entity = 0;
    size_t snapshot = 0;
    uint16_t reason = 0;
  };

  /// What a rule proposes of an entity: indices into its snapshots, with their order. Those that
  /// went, and those that `is_queued`, are not seen.
  struct Asked {
    std::vector<ForgetProposal> proposals;
    std::string reason;
  };
  Result<Asked> ask(const ForgetRule& rule, const Entity& entity,
                    const std::vector<bool>& is_queued);

  Status check_stop(const std::string& what, size_t done);
  uint16_t reason_number(const std::string& reason);
  [[nodiscard]] bool may_go(const Entity& entity, size_t snapshot) const;
  [[nodiscard]] uint64_t wanted_bytes(const ForgetOptions& options) const;
  Result<std::vector<Candidate>> candidates_of(const ForgetRule& rule, size_t rank,
                                               std::vector<std::vector<bool>>& is_queued);
  Status follow_links(std::vector<std::pair<size_t, size_t>>& waiting);
  [[nodiscard]] FreedBytes freed() const;
  [[nodiscard]] uint64_t freed_model_bytes(const Entity& entity) const;
  [[nodiscard]] EntityForgetPlan plan_of(const Entity& entity, const FreedBytes& shares) const;

  ForgetSource& source_;
  const ForgetProtection& protection_;
  const ForgetContext& context_;
  std::vector<Entity> entities_;  ///< In the order of their names.
  std::vector<std::string> reasons_{"stays"};
  uint64_t missing_bytes_ = 0;
};

}  // namespace engram::ltm
