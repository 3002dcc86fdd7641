// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "ltm/core/status.h"

namespace engram::experiments {

/// Time since it was made or restarted, by the steady clock.
class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  /// The time so far; the next one counts from here.
  double restart();

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Processor time of all threads of this process so far. Unlike wall time it hardly depends on what
/// else the machine does.
[[nodiscard]] double cpu_seconds();

/// What many timings of one operation come to. Unit: seconds.
struct Latency {
  double median = 0;
  double p99 = 0;
  double max = 0;
};

/// The smallest value that at least `share` of them do not exceed. Needs one value (checked).
[[nodiscard]] double quantile(std::vector<double> values, double share);

/// Needs one value (checked).
[[nodiscard]] Latency summarize(const std::vector<double>& seconds);

/// What the environment's ENGRAM_RECORDINGS names; empty where it is not set.
[[nodiscard]] std::filesystem::path recordings_folder();

/// All files in a folder whose names end so (".mp4"), at any depth, in the order of their paths.
/// Errors: kNotFound, kUnavailable naming the folder.
Result<std::vector<std::filesystem::path>> files_below(const std::filesystem::path& folder,
                                                       std::string_view extension);

/// Bytes of all files in a folder, at any depth.
Result<uint64_t> tree_bytes(const std::filesystem::path& folder);

/// Forces all files in a folder to the disk.
Status sync_tree(const std::filesystem::path& folder);

/// Asks the system to forget what it cached of all files in a folder, which are on the disk: the
/// next read is cold, as far as the disk itself caches nothing.
Status drop_cached(const std::filesystem::path& folder);

/// Makes a folder anew, without what was in it.
Status make_empty(const std::filesystem::path& folder);

/// Resident memory of this process, and the most since reset_peak_memory.
struct Memory {
  uint64_t now_bytes = 0;
  uint64_t peak_bytes = 0;
};
Result<Memory> memory();
Status reset_peak_memory();

}  // namespace engram::experiments
