// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/idf/data.h"
#include "ltm/idf/type.h"
#include "ltm/idf/type_check.h"

namespace engram::idf {

/// Something that a cast could not keep as it was.
struct CastNote {
  enum class Kind {
    kMismatch,  ///< Not of the type: the default stands there instead.
    kMissing,   ///< Nothing there: the default stands there.
    kUnknown,   ///< The type has no such member or element: dropped.
    kNarrowed,  ///< Taken, but rounded to the nearest number that the type holds.
  };

  Kind kind = Kind::kMismatch;
  Mismatch what;

  /// "narrowed: 'x': found float64 0.1, needs float32".
  [[nodiscard]] std::string to_string() const;

  friend bool operator==(const CastNote&, const CastNote&) = default;
};

[[nodiscard]] std::string_view to_string(CastNote::Kind kind);

/// A value of the type, and what was not kept.
struct CastResult {
  Data value;
  std::vector<CastNote> notes;

  /// True where nothing at all was lost.
  [[nodiscard]] bool is_complete() const { return notes.empty(); }
};

/// Takes from `value` what fits `type`.
///
/// Numbers go over silently where the type holds them exactly: every widening (int32 to int64 or
/// float64, float32 to float64, the same for elements of arrays), and narrowing that changes
/// nothing. A float that must be rounded is rounded and noted; an integer that is out of range or
/// would get a fraction cut off is no match. Arrays are taken or left whole. Members come in the
/// order of the type; an optional member that is missing is none, without a note.
///
/// For all values x and types T: check(cast(x, T).value, T) is empty; cast(cast(x, T).value, T)
/// gives the same value without a note; where check(x, T) is empty there is no note, and the value
/// is x but for the order of members.
[[nodiscard]] CastResult cast(const Data& value, const Type& type);

/// The value of a type where nothing is known: zeros (or what is closest to zero within the
/// bounds), empty texts, lists and free axes, the first value of an enum, the identity rotation,
/// none for all that is optional.
[[nodiscard]] Data default_value(const Type& type);

}  // namespace engram::idf
