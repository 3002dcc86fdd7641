// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <compare>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "ltm/recall/known_past.h"
#include "ltm/recall/prefix_order.h"
#include "ltm/store/store_reader.h"

namespace engram::ltm {

/// A snapshot in the order in which a memory took them: by arrival, then by its own time.
struct Arrival {
  Time arrived{};
  Time time{};

  friend auto operator<=>(const Arrival&, const Arrival&) = default;
};

/// When the snapshots of one entity arrived at the memory that recorded them, so that it can be
/// told which of them were there at a moment.
///
/// Snapshots that arrived at their own times, as those of an import did, need no list: their
/// timeline tells. Of others it holds 16 bytes each, and 7 more if they did not arrive in the order
/// of their times.
/// Threading: immutable.
/// Source: docs/replay.md, "What was there when".
class EntityArrivals {
 public:
  /// What arrived further from its own time was not measured then but imported, as by a program
  /// that stamps what it reads from files. It counts as arrived at its own time.
  static constexpr Duration kMaxDelay = std::chrono::minutes(10);

  /// Reads the arrival of each snapshot that a store has of an entity.
  /// Errors: those of StoreReader::arrivals.
  /// Complexity: O(snapshots), without reading any value; O(segments) if all arrived at their
  /// times.
  static Result<std::shared_ptr<const EntityArrivals>> read(StoreReader& store,
                                                            const MemoryId& entity);

  /// Needs times that increase, and an arrival for each (checked).
  EntityArrivals(std::vector<Time> times, std::vector<Time> arrived);

  /// Of an entity whose snapshots arrived at their own times.
  EntityArrivals() = default;

  /// Whether all arrived at their own times. Then the other functions must not be called (checked).
  [[nodiscard]] bool is_in_time() const { return is_in_time_; }

  /// How many snapshots had arrived at `now`. These are the first so many in the order of arrivals,
  /// and what the functions below that are given their number tell of.
  /// Complexity: O(log snapshots), as of all that follow.
  [[nodiscard]] size_t arrived_until(Time now) const;

  /// How many of the first `arrived` are before `time`.
  [[nodiscard]] size_t before(Time time, size_t arrived) const;

  /// The time of the first `arrived` with this index in the order of times (checked).
  [[nodiscard]] Time nth_time(size_t index, size_t arrived) const;

  /// The times of the first `arrived`, in their order.
  /// Complexity: O(snapshots).
  [[nodiscard]] std::vector<Time> times(size_t arrived) const;

  /// The first snapshot behind `after` in the order of arrivals.
  [[nodiscard]] std::optional<Arrival> next(const Arrival& after) const;

 private:
  [[nodiscard]] Arrival nth(size_t place) const;
  /// The place of the first behind `after` in the order of arrivals.
  [[nodiscard]] size_t behind(const Arrival& after) const;

  bool is_in_time_ = true;
  std::vector<Time> times_;         ///< In order.
  std::vector<Time> arrived_;       ///< Of each.
  std::vector<uint32_t> in_order_;  ///< Indices in the order of arrivals; empty: as they are.
  PrefixOrder by_time_;             ///< Of `in_order_`.
};

/// The past of an entity as it was at `now`: nothing that arrived later. Null if that leaves none.
/// `past` may be null.
/// Errors: those of Moments.
Result<std::unique_ptr<EntityPast>> arrived_past(std::unique_ptr<EntityPast> past,
                                                 std::shared_ptr<const EntityArrivals> arrivals,
                                                 Time now);

}  // namespace engram::ltm
