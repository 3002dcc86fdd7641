// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/idf/type.h"
#include "ltm/memory/memory_id.h"

namespace engram::server {

/// RAM of a machine or a control group. Unit: bytes.
struct RamState {
  uint64_t total_bytes = 0;
  uint64_t available_bytes = 0;  ///< Available without swapping.

  friend bool operator==(const RamState&, const RamState&) = default;
};

/// The share of the last 10 s in which some tasks, or all tasks, waited for a resource (Linux's
/// pressure stall information, PSI).
/// Unit: %.
struct Pressure {
  double some = 0;
  std::optional<double> full;  ///< Older kernels do not report it for the CPU.

  friend bool operator==(const Pressure&, const Pressure&) = default;
};

/// A file system. The sizes are empty if it cannot be read, for example after a disk was unplugged.
struct DiskState {
  std::string path;
  std::optional<uint64_t> total_bytes;
  std::optional<uint64_t> free_bytes;  ///< Free for this user.

  friend bool operator==(const DiskState&, const DiskState&) = default;
};

/// The load of a machine at one moment.
struct HostState {
  std::optional<double> cpu_share;  ///< Busy share of all cores since the last reading, 0..1.
  RamState ram;
  /// The control group (v2) around this process with the least RAM left; empty if no group has a
  /// limit.
  std::optional<RamState> group_ram;
  std::optional<Pressure> cpu_pressure;  ///< Empty if the kernel does not measure pressure.
  std::optional<Pressure> memory_pressure;
  std::optional<Pressure> io_pressure;
  std::vector<DiskState> disks;
  uint64_t process_bytes = 0;  ///< RAM of this process.

  /// Returns the RAM of the machine or of the group, whichever has less left.
  [[nodiscard]] const RamState& tightest_ram() const;

  friend bool operator==(const HostState&, const HostState&) = default;
};

/// How much RAM working memory may take, and why.
struct RamLimit {
  uint64_t bytes = 0;
  std::string reason;
};

/// Converts a state to a value of host_state_type().
[[nodiscard]] idf::Data to_data(const HostState& state,
                                const std::optional<RamLimit>& limit = std::nullopt);

/// The type of the core segment `SystemState/Host`.
[[nodiscard]] idf::Type host_state_type();

/// The entity that stores these snapshots: `SystemState/Host/<host>/load`.
/// Errors: kInvalidArgument if the name is empty or not UTF-8.
Result<ltm::MemoryId> host_state_entity(std::string_view host);

}  // namespace engram::server
