// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "ltm/core/status.h"

namespace engram::experiments {

/// Measures the time since it was made or restarted, by the steady clock.
class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  /// Returns the time so far and starts again from zero.
  double restart();

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Processor time of all threads of this process so far. Unlike wall time, it hardly depends on the
/// load of the machine.
[[nodiscard]] double cpu_seconds();

/// Statistics of many timings of one operation. Unit: seconds.
struct Latency {
  double median = 0;
  double p99 = 0;
  double max = 0;
};

/// The smallest value that at least `share` of them do not exceed. There must be a value (checked).
[[nodiscard]] double quantile(std::vector<double> values, double share);

/// There must be at least one value (checked).
[[nodiscard]] Latency summarize(const std::vector<double>& seconds);

/// The folder that the environment variable ENGRAM_RECORDINGS names; empty if it is not set.
[[nodiscard]] std::filesystem::path recordings_folder();

/// Returns all files in a folder with this extension (".mp4"), at any depth, in the order of paths.
/// Errors: kNotFound, kUnavailable naming the folder.
Result<std::vector<std::filesystem::path>> files_below(const std::filesystem::path& folder,
                                                       std::string_view extension);

/// Returns the bytes of all files in a folder, at any depth.
Result<uint64_t> tree_bytes(const std::filesystem::path& folder);

/// Forces all files in a folder to the disk.
Status sync_tree(const std::filesystem::path& folder);

/// Asks the system to drop all files in a folder, which are on the disk, from its cache. The next
/// read is cold, except for caches of the disk itself.
Status drop_cached(const std::filesystem::path& folder);

/// Makes an empty folder, removing what was in it.
Status make_empty(const std::filesystem::path& folder);

/// Resident memory of this process, and its maximum since reset_peak_memory.
struct Memory {
  uint64_t now_bytes = 0;
  uint64_t peak_bytes = 0;
};
Result<Memory> memory();
Status reset_peak_memory();

}  // namespace engram::experiments
