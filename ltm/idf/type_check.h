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

/// How far the norm of an orientation may be from 1.
inline constexpr double kUnitTolerance = 1e-3;

/// One place where a value is not of its type.
struct Mismatch {
  std::string path;  ///< As Data::at reads it; empty: the value itself.
  std::string found;
  std::string needed;

  /// "'pose/position': found ndarray float64 [3], needs ndarray float32 [3]".
  [[nodiscard]] std::string to_string() const;

  friend bool operator==(const Mismatch&, const Mismatch&) = default;
};

/// Everything in `value` that is not as `type` says, in walk order; empty: it fits.
///
/// An array is reported once, not once per element. Members may stand in any order; an optional
/// one that is absent is there as none.
/// Complexity: O(nodes of the value); elements are read only where they are bounded or a rotation.
[[nodiscard]] std::vector<Mismatch> check(const Data& value, const Type& type);

/// The first mismatches as one error; ok where there is none.
/// Errors: kInvalidArgument.
Status to_status(const std::vector<Mismatch>& mismatches);

/// "int32 5", "ndarray float32 [3]", "list of 2", "none": a value in a few words.
[[nodiscard]] std::string describe(const Data& value);

/// What a value of `type` is in a few words: "int32", "ndarray float32 [*, 3]", "dict (Object
/// Cup)".
[[nodiscard]] std::string describe(const Type& type);

/// What is wrong with a value of a type without parts (scalars and arrays); nothing if it fits.
/// The path of the mismatch is empty. Optional is not looked at.
[[nodiscard]] std::optional<Mismatch> check_leaf(const Data& value, const Type& type);

}  // namespace engram::idf
