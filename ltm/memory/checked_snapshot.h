// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "ltm/memory/segment_types.h"
#include "ltm/memory/snapshot.h"

namespace engram::ltm {

/// What every memory asks of updates that come as one before it takes any of them.
/// Errors: kInvalidArgument naming the update: its ID is no entity, it has no instance, or there is
/// another of the same entity and time.
/// Complexity: O(number of updates).
[[nodiscard]] Status check_updates(std::span<const Snapshot* const> updates);

/// Where snapshots are; valid as long as they stay there.
[[nodiscard]] std::vector<const Snapshot*> pointers_to(std::span<const Snapshot> snapshots);

/// What a cast to their segment's type did to the values of a snapshot.
struct SnapshotCast {
  bool is_cast = false;            ///< Some value is not as it came.
  std::vector<std::string> notes;  ///< What it cost: one of each instance that lost something.
};

/// Makes the values of a snapshot what their segment's type wants; where it has none they stay.
/// Errors: kInvalidArgument with all paths that do not fit; the snapshot may be cast in part.
Result<SnapshotCast> cast_to_type(Snapshot& snapshot, const SegmentTypes& types);

/// A snapshot whose values are of the type that its segment had when it was checked.
///
/// The check alone makes one, and gives it out as it stays: nobody can have one whose values may be
/// changed. So who gets one need not look at its values again, only at whether the type is the same.
///
/// Threading: immutable.
class CheckedSnapshot : public Snapshot {
 public:
  /// Values that were checked; only check() can make it.
  class Proof {
   private:
    friend class CheckedSnapshot;
    Proof(Snapshot checked, std::optional<idf::Type> of)
        : snapshot(std::move(checked)), type(std::move(of)) {}

    Snapshot snapshot;
    std::optional<idf::Type> type;
  };

  template <typename T>
  struct Checked {
    std::shared_ptr<const T> snapshot;
    SnapshotCast cast;
  };

  CheckedSnapshot(Proof proof, const SnapshotCast& cast);
  CheckedSnapshot(const CheckedSnapshot&) = delete;
  CheckedSnapshot& operator=(const CheckedSnapshot&) = delete;

  /// Casts a snapshot to its segment's type and makes a T of it: T(Proof, SnapshotCast, more...).
  /// Errors: those of cast_to_type.
  template <std::derived_from<CheckedSnapshot> T = CheckedSnapshot, typename... More>
  static Result<Checked<T>> check(Snapshot snapshot, const SegmentTypes& types, More&&... more) {
    ENGRAM_ASSIGN_OR_RETURN(SnapshotCast cast, cast_to_type(snapshot, types));
    const idf::Type* type = types.of_entity(snapshot.entity);
    Proof proof(std::move(snapshot), type == nullptr ? std::nullopt : std::optional(*type));
    auto made = std::make_shared<const T>(std::move(proof), cast, std::forward<More>(more)...);
    return Checked<T>{std::move(made), std::move(cast)};
  }

  /// Whether its values are what `types` want of them now: the type of its segment is the one that
  /// it was checked against, or there is none.
  /// Complexity: O(1) where both have the type from the same declaration, else that of the type.
  [[nodiscard]] bool is_of(const SegmentTypes& types) const;

 private:
  std::optional<idf::Type> type_;  ///< Nothing: its segment had none.
};

}  // namespace engram::ltm
