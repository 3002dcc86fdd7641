// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the numbers of an episode.

#include <filesystem>

#include "datasets/media/table.h"

namespace engram::datasets::lerobot {

/// Where the table of an episode is as CSV: beside the Parquet file, or below tables/ of the data
/// set. Empty where it is not.
[[nodiscard]] std::filesystem::path csv_of(const std::filesystem::path& root,
                                           const std::filesystem::path& parquet);

/// Reads the CSV where there is one, else the Parquet file through pyarrow.
/// Errors: kNotFound where there is neither; kFailedPrecondition where Python has no pyarrow,
/// saying what to do; those of Table::read.
Result<Table> read_table(const std::filesystem::path& root, const std::filesystem::path& parquet);

}  // namespace engram::datasets::lerobot
