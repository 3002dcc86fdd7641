// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/robot/host_reader.h"
#include "server/robot/limit_governor.h"
#include "server/robot/memory_server.h"

namespace engram::server {

/// Watches the machine: commits its state to the System State memory, and lets the working memories
/// of servers shrink and grow with the available RAM.
///
/// Threading: one thread.
/// Source: docs/working_memory.md, section "How much of the machine".
class HostWatch {
 public:
  struct Watched {
    MemoryServer* server = nullptr;  ///< Must outlive this object.
    ltm::MemoryLimits limits;        ///< The configured limits; `bytes` must be set.
    uint64_t min_bytes = 0;
    bool has_system_state = false;  ///< True for one server at most.
  };
  struct Options {
    HostReader::Options reader;
    std::string host;  ///< Name of the machine.
  };

  /// Creates a watch and declares the type of System State at the server that has it.
  /// Errors: those of LimitGovernor::create and memory::MemoryService::declare.
  static Result<HostWatch> create(const Options& options, const std::vector<Watched>& watched);

  /// Reads the machine once, adjusts the limits and commits the state. A failure is logged when it
  /// begins, not at every look.
  void look(SteadyTime now);

 private:
  struct Governed {
    Watched watched;
    LimitGovernor governor;
  };

  HostWatch(const Options& options, ltm::MemoryId entity);
  void govern(Governed& governed, SteadyTime now, const HostState& host);
  Status commit(const HostState& host);
  [[nodiscard]] RamLimit limit_of_all() const;

  HostReader reader_;
  ltm::MemoryId entity_;
  std::vector<Governed> governed_;
  std::string last_problem_;
};

}  // namespace engram::server
