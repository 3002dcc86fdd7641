// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/memory/snapshot.h"

namespace engram::ltm {

/// The new state of one entity: its ID, the time, and the instances with their metadata.
using EntityUpdate = Snapshot;

/// A group of entity updates that a producer hands over together.
struct Commit {
  std::vector<EntityUpdate> updates;

  /// Checks what every memory requires of a commit before it takes any of it.
  /// Errors: kInvalidArgument naming the update: its ID is no entity, it has no instance, or the
  /// commit holds another of the same entity and time.
  /// Complexity: O(number of updates).
  [[nodiscard]] Status check() const;

  /// Returns {"updates": [Snapshot::to_data()]}.
  [[nodiscard]] idf::Data to_data() const;

  /// Reads what to_data wrote; safe on hostile values. The result need not pass check().
  /// Errors: kInvalidArgument naming the member, what was found and what was needed.
  static Result<Commit> from_data(const idf::Data& data);

  friend bool operator==(const Commit&, const Commit&) = default;
};

}  // namespace engram::ltm
