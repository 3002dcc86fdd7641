// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <queue>
#include <tuple>
#include <vector>

#include "ltm/recall/replayed_past.h"

namespace engram::memory {

/// The snapshots of all entities of a store in the order in which the memory took them: by arrival;
/// those that arrived in the same nanosecond, which are those of one commit, by their IDs. The
/// order of updates within a commit is not recorded.
///
/// It holds one snapshot's time for each entity, whatever their number.
/// Threading: one thread.
/// Source: docs/replay.md, "What was there when".
class ArrivalOrder {
 public:
  /// `past` must outlive it and show everything.
  explicit ArrivalOrder(ltm::ReplayedPast& past);

  /// Begins anew behind everything that had arrived at `now`. Costs nothing; prepare() then does.
  void restart(Time now);

  /// Looks up where at most `max` further entities go on. Returns whether it is done with all.
  /// Entities whose times cannot be read are left out, and logged.
  /// Errors: kUnavailable if the store has to be renewed.
  Result<bool> prepare(size_t max);

  /// When the next snapshots arrived; nothing behind the last ones. Needs to be prepared (checked).
  [[nodiscard]] std::optional<Time> next() const;

  /// The IDs of all snapshots of the next arrival, which it passes. Needs one (checked).
  /// Errors: kUnavailable as prepare(); then it has to be restarted.
  Result<std::vector<ltm::MemoryId>> take();

 private:
  /// Arrival, entity and time of a snapshot; compares in this order.
  using Place = std::tuple<Time, size_t, Time>;

  Status push_next(size_t entity, const ltm::Arrival& after);
  Result<std::optional<ltm::Arrival>> next_of(size_t entity, const ltm::Arrival& after);

  ltm::ReplayedPast& past_;
  std::vector<ltm::MemoryId> entities_;
  Time from_{};
  size_t prepared_ = 0;  ///< So many of the entities are in `places_`.
  std::priority_queue<Place, std::vector<Place>, std::greater<>> places_;
};

}  // namespace engram::memory
