// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "server/robot/host_state.h"

namespace engram::server {

/// Reads how busy this machine is, from /proc, the control groups (v2) and the file systems. Meant
/// to be asked once per second: that takes well below a millisecond.
///
/// What control groups limit is looked for from the process's group up to the outermost one. Pages
/// of files that nobody used lately (inactive_file) count as available there, as they do in
/// MemAvailable.
/// Threading: one thread.
class HostReader {
 public:
  struct Options {
    std::filesystem::path root = "/";          ///< Below which proc/ and sys/ are.
    std::vector<std::filesystem::path> disks;  ///< A path on each file system.
  };

  explicit HostReader(Options options) : options_(std::move(options)) {}

  /// Errors: kNotFound, kUnavailable or kDataLoss naming the file in proc/ or sys/.
  Result<HostState> read();

 private:
  /// Of all cores since the machine started. Unit: ticks.
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
