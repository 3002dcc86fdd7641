// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "ltm/memory/query.h"

namespace engram::ltm {

/// The times of an entity's snapshots, which are looked for and not listed: there may be millions.
class Moments {
 public:
  virtual ~Moments() = default;

  /// Nothing where the entity has no snapshot.
  /// Errors, here and below: kDataLoss, kUnavailable.
  virtual Result<std::optional<Time>> first() = 0;
  virtual Result<std::optional<Time>> last() = 0;

  /// The snapshot closest to `time` on that side, itself included; nothing where there is none.
  virtual Result<std::optional<Time>> at_or_after(Time time) = 0;
  virtual Result<std::optional<Time>> at_or_before(Time time) = 0;

  /// Snapshot number `index` from the first; nothing behind the last.
  virtual Result<std::optional<Time>> nth(uint64_t index) = 0;
};

/// What a selector means for one entity.
struct Selection {
  /// All snapshots from the first to the last of these times, which are times of snapshots.
  struct Span {
    Time first{};
    Time last{};

    friend bool operator==(const Span&, const Span&) = default;
  };
  std::optional<Span> snapshots;
  /// A moment after the last snapshot that is asked for.
  std::optional<Time> future;

  friend bool operator==(const Selection&, const Selection&) = default;
};

/// One snapshot that is asked for.
struct SelectedSnapshot {
  Time time{};
  bool is_future = false;  ///< Behind the last snapshot: to be predicted.
  /// Indices of the instances that are asked for, increasing; empty: all.
  std::vector<int32_t> instances;

  friend bool operator==(const SelectedSnapshot&, const SelectedSnapshot&) = default;
};

/// Applies `selector` to the snapshots of an entity.
/// Errors: those of Moments.
/// Complexity: a few questions; for `Latest n` and index ranges as many as the index is far away
/// from the end.
Result<Selection> select_times(const Selector& selector, Moments& moments);

/// Unites what several selectors mean for one entity: in the order of time, each moment once, with
/// all the instances that any of them asks for.
/// Errors: those of Moments.
/// Complexity: O(m log m) in the number of answers.
Result<std::vector<SelectedSnapshot>> select_snapshots(std::span<const SnapshotQuery> queries,
                                                       Moments& moments);

}  // namespace engram::ltm
