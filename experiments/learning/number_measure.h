// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "learning/number_data.h"

namespace engram::experiments {

/// Returns the maximum error of decoded numbers. Equal bits are no error, so NaN may stay NaN.
/// `name` is the name of the recording, for the message.
/// Shape: rows and decoded alike (checked).
/// Errors: kDataLoss naming the first number whose error exceeds `bound`.
Result<double> largest_error(const std::string& name, std::span<const double> rows,
                             std::span<const double> decoded, double bound);

/// The sizes that general compressors reach. Unit: bytes of all recordings.
struct RivalBytes {
  double floats = 0;       ///< 32-bit floats row by row, zstd 19.
  double differences = 0;  ///< Differences of steps of twice the bound, by column, zstd 19.
  double steps = 0;        ///< These steps by column, compress_column.
};

/// Steps take two bytes each if all of a recording fit, else four.
/// Errors: kInvalidArgument naming recording, column and number if a step does not fit four bytes.
Result<RivalBytes> rival_bytes(std::span<const NumberRecording> recordings, double bound);

}  // namespace engram::experiments
