// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "ltm/idf/data.h"

namespace engram::idf {

/// About what a value takes in RAM besides the elements of its arrays: a dict of ten numbers takes
/// nine times their bytes. Unit: bytes.
/// Complexity: O(number of nodes); arrays are not read.
[[nodiscard]] size_t held_bytes(const Data& data);

/// The elements of its arrays. Unit: bytes. Complexity: like held_bytes.
[[nodiscard]] size_t element_bytes(const Data& data);

}  // namespace engram::idf
