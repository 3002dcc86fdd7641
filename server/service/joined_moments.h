// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "ltm/recall/select.h"
#include "ltm/store/timeline.h"
#include "server/memory/held_snapshot.h"

namespace engram::server {

/// The moments of an entity that are in working memory, in the store, or in both.
///
/// Threading: one thread.
class JoinedMoments final : public ltm::Moments {
 public:
  /// `held` in the order of time; `stored` may be null. Both outlive it.
  JoinedMoments(std::span<const SharedSnapshot> held, ltm::Timeline* stored)
      : held_(held), stored_(stored) {}

  [[nodiscard]] std::optional<Time> first() const override;
  [[nodiscard]] std::optional<Time> last() const override;
  Result<std::optional<Time>> at_or_after(Time time) override;
  Result<std::optional<Time>> at_or_before(Time time) override;
  /// Complexity: O(held * log stored) where the two overlap.
  Result<std::optional<Time>> nth(uint64_t index) override;

  /// The one of exactly this time that is held.
  [[nodiscard]] SharedSnapshot find(Time time) const;

 private:
  /// Held snapshots whose moments are not stored too.
  Status find_unstored();

  std::span<const SharedSnapshot> held_;
  ltm::Timeline* stored_;
  std::optional<std::vector<Time>> unstored_;
};

}  // namespace engram::server
