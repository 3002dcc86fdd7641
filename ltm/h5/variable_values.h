// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to ltm/h5: reads values of variable length without HDF5, which crashes if their
// references are damaged.

#include <string>
#include <vector>

#include "ltm/h5/raw_file.h"

namespace engram::h5 {

/// Size of a reference in a file, in bytes.
inline constexpr uint64_t kReferenceBytes = 16;

/// Reads the values of the first `count` references.
/// Errors: kDataLoss naming the offset, what was found and what was needed.
/// Source: HDF5 file format specification 3.0, section III.E.
Result<std::vector<std::string>> variable_values(const RawFile& file, RawView references,
                                                 uint64_t count);

}  // namespace engram::h5
