// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ltm/core/status.h"

namespace engram::experiments {

/// The numbers of one recording. Shape: rows [K, columns.size()].
struct NumberRecording {
  std::string name;
  std::vector<std::string> columns;
  std::vector<double> rows;

  [[nodiscard]] size_t count() const { return columns.empty() ? 0 : rows.size() / columns.size(); }
};

/// Reads every `stride`-th row of all CSV files below a folder, in the order of their names. Only
/// columns that begin with one of `prefixes` are read, in the order of the prefixes. Errors:
/// kNotFound if there are none; kInvalidArgument if the columns of two files differ; those of
/// reading a table.
Result<std::vector<NumberRecording>> read_numbers(const std::filesystem::path& folder,
                                                  const std::vector<std::string>& prefixes,
                                                  size_t stride);

}  // namespace engram::experiments
