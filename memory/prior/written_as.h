// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/idf/type.h"

namespace engram::memory {

/// The value with arrays where the type has arrays and lists of numbers stand (`[0, 0, 1.5]`,
/// nested for each axis), the value of an enum where its name stands, and nanoseconds where a time
/// stands as text. All else is left as it is, for whoever checks it.
[[nodiscard]] idf::Data written_as(const idf::Type& type, idf::Data value);

}  // namespace engram::memory
