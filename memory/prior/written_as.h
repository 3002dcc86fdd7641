// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/idf/type.h"

namespace engram::memory {

/// Converts the readable forms in a value to what `type` wants: lists of numbers (`[0, 0, 1.5]`,
/// nested for each axis) become arrays, the names of an enum become its values, and times in text
/// become nanoseconds. Everything else stays as it is, and the later check of the type reports it.
[[nodiscard]] idf::Data written_as(const idf::Type& type, idf::Data value);

}  // namespace engram::memory
