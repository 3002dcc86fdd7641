// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace engram::datasets {

/// Counts what an export wrote and what it could not write.
struct ExportReport {
  uint64_t snapshots = 0;  ///< Snapshots that were given to the export.
  uint64_t instances = 0;
  uint64_t files = 0;
  uint64_t bytes = 0;
  /// What the format cannot carry, in words ("lists and texts"), and how often it occurred.
  std::map<std::string, uint64_t, std::less<>> not_carried;

  friend bool operator==(const ExportReport&, const ExportReport&) = default;
};

}  // namespace engram::datasets
