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

/// RAM. Unit: bytes.
struct RamState {
  uint64_t total_bytes = 0;
  uint64_t available_bytes = 0;  ///< Without swapping.

  friend bool operator==(const RamState&, const RamState&) = default;
};

/// For what share of the last 10 s somebody, or everybody, waited for a resource (Linux's PSI).
/// Unit: %.
struct Pressure {
  double some = 0;
  std::optional<double> full;  ///< Older kernels do not know it for the CPU.

  friend bool operator==(const Pressure&, const Pressure&) = default;
};

/// A file system. Nothing where it cannot be asked: a disk that was unplugged.
struct DiskState {
  std::string path;
  std::optional<uint64_t> total_bytes;
  std::optional<uint64_t> free_bytes;  ///< For us.

  friend bool operator==(const DiskState&, const DiskState&) = default;
};

/// How busy a machine is right now.
struct HostState {
  std::optional<double> cpu_share;  ///< Of all cores since the last reading, 0..1.
  RamState ram;
  /// Of the control group (v2) around this process that has the least left; nothing without limits.
  std::optional<RamState> group_ram;
  std::optional<Pressure> cpu_pressure;  ///< Nothing where the kernel does not measure it.
  std::optional<Pressure> memory_pressure;
  std::optional<Pressure> io_pressure;
  std::vector<DiskState> disks;
  uint64_t process_bytes = 0;  ///< RAM of this process.

  /// Of the machine and the group, the one that has less left.
  [[nodiscard]] const RamState& tightest_ram() const;

  friend bool operator==(const HostState&, const HostState&) = default;
};

/// What working memory may take, and why that much.
struct RamLimit {
  uint64_t bytes = 0;
  std::string reason;
};

/// The state as a value of host_state_type().
[[nodiscard]] idf::Data to_data(const HostState& state,
                                const std::optional<RamLimit>& limit = std::nullopt);

/// The type of the core segment `SystemState/Host`.
[[nodiscard]] idf::Type host_state_type();

/// The entity whose snapshots these are: `SystemState/Host/<host>/load`.
/// Errors: kInvalidArgument where the name is empty or no UTF-8.
Result<ltm::MemoryId> host_state_entity(std::string_view host);

}  // namespace engram::server
