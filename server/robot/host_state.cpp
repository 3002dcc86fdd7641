// SPDX-License-Identifier: Apache-2.0
#include "server/robot/host_state.h"

#include <algorithm>
#include <limits>

namespace engram::server {

using idf::Data;
using idf::Dict;
using idf::Type;

namespace {

Data bytes_data(uint64_t bytes) {
  constexpr auto kMax = static_cast<uint64_t>(std::numeric_limits<int64_t>::max());
  // IDF has no unsigned integers. A size that does not fit becomes the largest, not a negative one.
  return static_cast<int64_t>(std::min(bytes, kMax));
}

// What could not be read is an absent member: zero would say that a disk is full.
Data bytes_data(const std::optional<uint64_t>& bytes) {
  return bytes ? bytes_data(*bytes) : Data();
}

Data ram_data(const RamState& ram) {
  return Dict{{"total", bytes_data(ram.total_bytes)},
              {"available", bytes_data(ram.available_bytes)}};
}

Data share_data(double share, double max) {
  return static_cast<float>(std::clamp(share, 0.0, max));
}

Data pressure_data(const std::optional<Pressure>& pressure) {
  if (!pressure) return {};
  return Dict{{"some", share_data(pressure->some, 100)},
              {"full", pressure->full ? share_data(*pressure->full, 100) : Data()}};
}

Type bytes_type() {
  return Type::int64({.unit = "B", .minimum = 0});
}

Type percent_type() {
  return Type::float32({.unit = "%", .minimum = 0, .maximum = 100});
}

}  // namespace

const RamState& HostState::tightest_ram() const {
  // A group with a limit may be full while the machine has RAM left, and the other way round.
  if (!group_ram) return ram;
  return group_ram->available_bytes < ram.available_bytes ? *group_ram : ram;
}

Data to_data(const HostState& state, const std::optional<RamLimit>& limit) {
  idf::List disks;
  for (const DiskState& disk : state.disks)
    disks.push_back(Dict{{"path", disk.path},
                         {"total", bytes_data(disk.total_bytes)},
                         {"free", bytes_data(disk.free_bytes)}});
  return Dict{
      {"cpu_share", state.cpu_share ? share_data(*state.cpu_share, 1) : Data()},
      {"ram", ram_data(state.ram)},
      {"group_ram", state.group_ram ? ram_data(*state.group_ram) : Data()},
      {"cpu_pressure", pressure_data(state.cpu_pressure)},
      {"memory_pressure", pressure_data(state.memory_pressure)},
      {"io_pressure", pressure_data(state.io_pressure)},
      {"disks", std::move(disks)},
      {"process_ram", bytes_data(state.process_bytes)},
      {"working_memory_limit", limit ? bytes_data(limit->bytes) : Data()},
      {"working_memory_reason", limit ? Data(limit->reason) : Data()},
  };
}

Type host_state_type() {
  const Type ram = Type::object(
      "host::Ram", {{"total", bytes_type()}, {"available", bytes_type(), "Without swapping."}});
  const Type pressure =
      Type::object("host::Pressure", {{"some", percent_type(), "Of 10 s that somebody waited."},
                                      {"full", percent_type().optional(), "... that all waited."}})
          .optional();
  const Type disk = Type::object("host::Disk", {{"path", Type::string()},
                                                {"total", bytes_type().optional()},
                                                {"free", bytes_type().optional()}});
  return Type::object(
      "host::State",
      {{"cpu_share", Type::float32({.unit = "", .minimum = 0, .maximum = 1}).optional(),
        "Of all cores since the last reading."},
       {"ram", ram},
       {"group_ram", ram.optional(), "Of the control group with the least left."},
       {"cpu_pressure", pressure},
       {"memory_pressure", pressure},
       {"io_pressure", pressure},
       {"disks", Type::list(disk)},
       {"process_ram", bytes_type(), "Of the server."},
       {"working_memory_limit", bytes_type().optional()},
       {"working_memory_reason", Type::string().optional(), "Why the limit is that."}});
}

Result<ltm::MemoryId> host_state_entity(std::string_view host) {
  return ltm::MemoryId::from_names({"SystemState", "Host", std::string(host), "load"});
}

}  // namespace engram::server
