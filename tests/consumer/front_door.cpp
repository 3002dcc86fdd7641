// SPDX-License-Identifier: Apache-2.0
// The program of README.md, section "From C++": tests/docs/front_door_test.py holds them together.
#include <fmt/format.h>

#include "memory/memory.h"

using namespace engram;

Status remember_and_ask(const std::string& path) {
  ENGRAM_ASSIGN_OR_RETURN(auto memory, Memory::open(path));
  ENGRAM_ASSIGN_OR_RETURN(const auto cup, ltm::MemoryId::parse("Objects/Things/kitchen/cup"));
  for (int64_t i = 0; i < 20; ++i) {
    idf::Dict value{{"x", 0.1 * static_cast<double>(i)}};
    ENGRAM_RETURN_IF_ERROR(memory->commit({{{cup, time_from_ns(i * 200'000'000), {{value, {}}}}}}));
  }
  ENGRAM_ASSIGN_OR_RETURN(const auto past, memory->query("Objects @ last:1s"));
  ENGRAM_ASSIGN_OR_RETURN(const auto future, memory->query("Objects @ +400ms"));
  const ltm::SnapshotResult& next = future.find_entity(cup)->snapshots.front();
  fmt::print("{} remembered, x will be {:.1f} ({})\n", past.snapshot_count(),
             next.instances[0].data.at("x")->get<double>(), next.predictor);
  return memory->close();
}

int main(int, char** argv) {
  const Status status = remember_and_ask(argv[1]);
  if (!status.ok()) fmt::print(stderr, "{}\n", status.to_string());
  return status.ok() ? 0 : 1;
}
