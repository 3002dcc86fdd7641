// SPDX-License-Identifier: Apache-2.0
// Remembers two snapshots of a type that is generated from XML, and asks for the last one.
#include <fmt/format.h>

#include "memory/memory.h"
#include "scene.h"

namespace {

engram::Status remember_and_ask(const char* path) {
  using namespace engram;
  ENGRAM_ASSIGN_OR_RETURN(const auto memory, Memory::open(path));
  ENGRAM_ASSIGN_OR_RETURN(const auto entity, ltm::MemoryId::parse("Object/Pose/tracker/cup"));
  ENGRAM_ASSIGN_OR_RETURN(const auto segment, ltm::MemoryId::parse("Object/Pose"));
  ENGRAM_RETURN_IF_ERROR(memory->declare(segment, tracker::Scene::idf_type()));
  for (const double x : {1.0, 2.0}) {
    tracker::Scene scene;
    scene.cup.x_m = x;
    const Time time = time_from_ns(static_cast<int64_t>(x * 1e9));
    ENGRAM_RETURN_IF_ERROR(memory->commit({{{entity, time, {{scene.to_idf(), {}}}}}}));
  }
  ENGRAM_ASSIGN_OR_RETURN(const auto answer, memory->query("Object/Pose/tracker/cup @ latest"));
  const ltm::EntityResult* cup = answer.find_entity(entity);
  ENGRAM_ASSIGN_OR_RETURN(const auto scene,
                          tracker::Scene::from_idf(cup->snapshots.front().instances.front().data));
  fmt::print("x = {}\n", scene.cup.x_m);
  return memory->close();
}

}  // namespace

int main(int, char** argv) {
  const engram::Status status = remember_and_ask(argv[1]);
  if (!status.ok()) fmt::print(stderr, "{}\n", status.to_string());
  return status.ok() ? 0 : 1;
}
