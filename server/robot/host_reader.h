// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "server/robot/host_state.h"

namespace engram::server {

/// Reads how busy this machine is, from /proc, the control groups (v2) and the file systems. It is
/// meant to be called once per second; a reading takes well below a millisecond.
///
/// The limits of control groups are read from the process's own group up to the outermost one. File
/// pages that have not been used lately (inactive_file) count as available in a group, as they do
/// in MemAvailable.
/// Threading: one thread.
class HostReader {
 public:
  struct Options {
    std::filesystem::path root = "/";          ///< The folder that holds proc/ and sys/.
    std::vector<std::filesystem::path> disks;  ///< One path on each file system to report.
  };

  explicit HostReader(Options options) : options_(std::move(options)) {}

  /// Errors: kNotFound, kUnavailable or kDataLoss naming the file in proc/ or sys/.
  Result<HostState> read();

 private:
  /// Times of all cores since the machine started. Unit: ticks.
  struct CpuTimes {
    uint64_t idle = 0;
    uint64_t total = 0;
  };

  Result<CpuTimes> read_cpu_times() const;
  Result<RamState> read_ram() const;
  Result<std::optional<RamState>> read_group_ram() const;
  Result<std::optional<Pressure>> read_pressure(std::string_view resource) const;
  Result<uint64_t> read_process_bytes() const;

  Options options_;
  std::optional<CpuTimes> last_;
};

}  // namespace engram::server
