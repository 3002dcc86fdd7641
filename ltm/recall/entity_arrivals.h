// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <compare>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "ltm/recall/known_past.h"
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
/// timeline tells. Of others it holds 16 bytes each, and 4 more if they did not arrive in the order
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

  /// The times of the snapshots that had arrived at `now`, in their order. `own` holds them where
  /// they are no prefix of all, and must live as long as the result.
  /// Complexity: O(log snapshots); O(snapshots) if they did not arrive in the order of their times.
  [[nodiscard]] std::span<const Time> arrived_until(Time now, std::vector<Time>& own) const;

  /// The first snapshot behind `after` in the order of arrivals.
  /// Complexity: O(log snapshots).
  [[nodiscard]] std::optional<Arrival> next(const Arrival& after) const;

 private:
  [[nodiscard]] Arrival nth(size_t place) const;

  bool is_in_time_ = true;
  std::vector<Time> times_;         ///< In order.
  std::vector<Time> arrived_;       ///< Of each.
  std::vector<uint32_t> in_order_;  ///< Indices in the order of arrivals; empty: as they are.
};

/// The past of an entity as it was at `now`: nothing that arrived later. Null if that leaves none.
/// `past` may be null.
/// Errors: those of Moments.
Result<std::unique_ptr<EntityPast>> arrived_past(std::unique_ptr<EntityPast> past,
                                                 std::shared_ptr<const EntityArrivals> arrivals,
                                                 Time now);

}  // namespace engram::ltm
