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

/// A part of a value that a cast could not keep as it was.
struct CastNote {
  enum class Kind {
    kMismatch,  ///< It is not of the type; the default replaces it.
    kMissing,   ///< It is absent; the default replaces it.
    kUnknown,   ///< The type has no such member or element; it was dropped.
    kNarrowed,  ///< It was rounded to the nearest number that the type holds.
  };

  Kind kind = Kind::kMismatch;
  Mismatch what;

  /// Prints "narrowed: 'x': found float64 0.1, needs float32".
  [[nodiscard]] std::string to_string() const;

  friend bool operator==(const CastNote&, const CastNote&) = default;
};

[[nodiscard]] std::string_view to_string(CastNote::Kind kind);

/// A value of the type, and the notes of what was lost.
struct CastResult {
  Data value;
  std::vector<CastNote> notes;

  /// True where nothing was lost.
  [[nodiscard]] bool is_complete() const { return notes.empty(); }
};

/// Casts what fits `type` from `value`.
///
/// Numbers are converted silently where the type holds them exactly: every widening (int32 to int64
/// or float64, float32 to float64, the same for elements of arrays), and narrowing that changes
/// nothing. A float that must be rounded is rounded and noted. An integer out of range, or one
/// whose fraction would be cut off, does not match. Arrays are taken as a whole or not at all.
/// Members come in the order of the type; an absent optional member becomes none, without a note.
///
/// For all values x and types T: check(cast(x, T).value, T) is empty; cast(cast(x, T).value, T)
/// gives the same value without a note; where check(x, T) is empty there is no note, and the value
/// is x except for the order of members.
[[nodiscard]] CastResult cast(const Data& value, const Type& type);

/// The default value of a type: zeros (or the numbers closest to zero within the bounds), empty
/// texts, lists and free axes, the first value of an enum, the identity rotation, and none for
/// everything optional.
[[nodiscard]] Data default_value(const Type& type);

}  // namespace engram::idf
