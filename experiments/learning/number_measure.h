// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "learning/number_data.h"

namespace engram::experiments {

/// How far decoded numbers lie from those of a recording at most; equal bits are no error, so that
/// what is not a number may stay one. `name` is the recording's, for the message.
/// Shape: rows and decoded alike (checked).
/// Errors: kDataLoss naming the first number that lies further off than `bound`.
Result<double> largest_error(const std::string& name, std::span<const double> rows,
                             std::span<const double> decoded, double bound);

/// What general compressors make of recordings. Unit: bytes of all of them.
struct RivalBytes {
  double floats = 0;       ///< 32-bit floats row by row, zstd 19.
  double differences = 0;  ///< Column by column, differences of steps of twice the bound, zstd 19.
  double steps = 0;        ///< Column by column, those steps, compress_column.
};

/// Steps take two bytes each where all of a recording fit, else four.
/// Errors: kInvalidArgument naming recording, column and number where a step does not fit four.
Result<RivalBytes> rival_bytes(std::span<const NumberRecording> recordings, double bound);

}  // namespace engram::experiments
