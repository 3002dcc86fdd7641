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

/// Checks what every memory requires of the updates of one commit before it takes any of them.
/// Errors: kInvalidArgument naming the update: its ID is no entity, it has no instance, or there is
/// another of the same entity and time.
/// Complexity: O(number of updates).
[[nodiscard]] Status check_updates(std::span<const Snapshot* const> updates);

/// Pointers to snapshots; valid as long as the snapshots stay where they are.
[[nodiscard]] std::vector<const Snapshot*> pointers_to(std::span<const Snapshot> snapshots);

/// What a cast to the segment's type did to the values of a snapshot.
struct SnapshotCast {
  bool is_cast = false;            ///< Some value was changed by the cast.
  std::vector<std::string> notes;  ///< The losses: one note for each instance that lost something.
};

/// Casts the values of a snapshot to the type of their segment; without a type they stay as they
/// are.
/// Errors: kInvalidArgument with all paths that do not fit; the snapshot may then be cast in part.
Result<SnapshotCast> cast_to_type(Snapshot& snapshot, const SegmentTypes& types);

/// A snapshot whose values have the type that its segment had when it was checked.
///
/// Only check() can make one, and it is immutable, so nobody can have one with unchecked values.
/// Its receivers need not check the values again, only whether the type is still the same.
///
/// Threading: immutable.
class CheckedSnapshot : public Snapshot {
 public:
  /// The proof that values were checked; only check() can make it.
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

  /// Whether the values are what `types` requires now: its segment has the type that it was checked
  /// against, or none.
  /// Complexity: O(1) where both have the type from the same declaration, otherwise that of
  /// comparing the types.
  [[nodiscard]] bool is_of(const SegmentTypes& types) const;

 private:
  std::optional<idf::Type> type_;  ///< Empty: its segment had no type.
};

}  // namespace engram::ltm
