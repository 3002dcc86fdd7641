// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ltm/memory/checked_snapshot.h"
#include "ltm/redaction/redactor.h"

namespace engram::ltm {

/// An update of a commit, with the values that filters and codecs read.
struct OfferedSnapshot {
  const Snapshot* given = nullptr;  ///< It must outlive this.
  std::optional<Snapshot> cast;     ///< Set if values were cast to their segment's type.
  std::vector<std::string> notes;   ///< What the casts lost.
  uint64_t raw_bytes = 0;
  bool is_redacted = false;  ///< It was, in the very form that it has now.
  RedactionOutcome redaction;

  [[nodiscard]] const Snapshot& snapshot() const { return cast ? *cast : *given; }

  /// Redacts it, in a copy whose arrays are shared as far as they do not change.
  void redact(Redactor& redactor);

  /// Checks the values of an update, and casts those that are not of their segment's type.
  /// Errors: those of cast_to_type.
  static Result<OfferedSnapshot> of(const Snapshot& update, const SegmentTypes& types);

  /// The same for an update that was checked before. Its values are checked again only if the
  /// segment's type has changed since. Whoever checked it redacted it, too.
  static Result<OfferedSnapshot> of(const CheckedSnapshot& update, const SegmentTypes& types);
};

}  // namespace engram::ltm
