// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/idf/data.h"
#include "ltm/idf/type.h"

namespace engram::idf {

/// How far the norm of an orientation may differ from 1.
inline constexpr double kUnitTolerance = 1e-3;

/// A part of a value that is not of its type.
struct Mismatch {
  std::string path;  ///< As Data::at reads it; empty: the whole value.
  std::string found;
  std::string needed;

  /// Prints "'pose/position': found ndarray float64 [3], needs ndarray float32 [3]".
  [[nodiscard]] std::string to_string() const;

  friend bool operator==(const Mismatch&, const Mismatch&) = default;
};

/// Everything in `value` that does not fit `type`, in walk order; empty where it fits.
///
/// An array is reported once, not once per element. Members may have any order; an optional member
/// without a value must be present as none.
/// Complexity: O(nodes of the value); elements are read only where they have bounds or form a
/// rotation.
[[nodiscard]] std::vector<Mismatch> check(const Data& value, const Type& type);

/// The first mismatches as one error; ok where there are none.
/// Errors: kInvalidArgument.
Status to_status(const std::vector<Mismatch>& mismatches);

/// Describes a value briefly: "int32 5", "ndarray float32 [3]", "list of 2", "none".
[[nodiscard]] std::string describe(const Data& value);

/// Describes the values of a type briefly: "int32", "ndarray float32 [*, 3]", "dict (Object Cup)".
[[nodiscard]] std::string describe(const Type& type);

/// The mismatch of a value with a type without parts (scalars and arrays); nothing if it fits. The
/// path of the mismatch is empty, and `optional` is ignored.
[[nodiscard]] std::optional<Mismatch> check_leaf(const Data& value, const Type& type);

}  // namespace engram::idf
