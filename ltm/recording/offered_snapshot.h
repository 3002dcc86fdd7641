// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ltm/memory/checked_snapshot.h"

namespace engram::ltm {

/// An update of a commit with the values that filters and codecs see.
struct OfferedSnapshot {
  const Snapshot* given = nullptr;  ///< Outlives this.
  std::optional<Snapshot> cast;     ///< Where its values are not as they came.
  std::vector<std::string> notes;   ///< What that cost.
  uint64_t raw_bytes = 0;

  [[nodiscard]] const Snapshot& snapshot() const { return cast ? *cast : *given; }

  /// Checks the values of an update, and casts them where they are not of their segment's type.
  /// Errors: those of cast_to_type.
  static Result<OfferedSnapshot> of(const Snapshot& update, const SegmentTypes& types);

  /// The same of one that was checked: its values are looked at only where the type is another now.
  static Result<OfferedSnapshot> of(const CheckedSnapshot& update, const SegmentTypes& types);
};

}  // namespace engram::ltm
