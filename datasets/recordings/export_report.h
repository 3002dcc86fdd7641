// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace engram::datasets {

/// What was written, and what could not be.
struct ExportReport {
  uint64_t snapshots = 0;  ///< That were handed over.
  uint64_t instances = 0;
  uint64_t files = 0;
  uint64_t bytes = 0;
  /// What the format cannot carry, in words ("lists and texts"), and how often that was met.
  std::map<std::string, uint64_t, std::less<>> not_carried;

  friend bool operator==(const ExportReport&, const ExportReport&) = default;
};

}  // namespace engram::datasets
