// SPDX-License-Identifier: Apache-2.0
// What needs the component `internals`: a recorder and a reader without the front door.
#include <fmt/format.h>

#include "ltm/recall/recall.h"
#include "ltm/recording/recorder.h"
#include "scene.h"

namespace {

engram::Status record_and_recall(const char* path) {
  using namespace engram;
  const auto entity = ltm::MemoryId::parse("Object/Pose/tracker/cup").value();
  {
    ENGRAM_ASSIGN_OR_RETURN(auto recorder, ltm::Recorder::open(path, {}));
    for (const double x : {1.0, 2.0}) {
      tracker::Scene scene;
      scene.cup.x_m = x;
      const ltm::Snapshot snapshot{
          entity, time_from_ns(static_cast<int64_t>(x * 1e9)), {{scene.to_idf(), {}}}};
      ENGRAM_RETURN_IF_ERROR(recorder.commit({{snapshot}}));
    }
    ENGRAM_RETURN_IF_ERROR(recorder.close());
  }
  ENGRAM_ASSIGN_OR_RETURN(auto reader, ltm::StoreReader::open(path));
  ltm::Recall recall(std::move(reader), {});
  ENGRAM_ASSIGN_OR_RETURN(const auto query, ltm::Query::parse("Object/Pose/tracker/cup @ latest"));
  ENGRAM_ASSIGN_OR_RETURN(const auto answer, recall.query(query));
  const ltm::EntityResult* cup = answer.find_entity(entity);
  ENGRAM_ASSIGN_OR_RETURN(const auto scene,
                          tracker::Scene::from_idf(cup->snapshots.front().instances.front().data));
  fmt::print("x = {}\n", scene.cup.x_m);
  return {};
}

}  // namespace

int main(int, char** argv) {
  const engram::Status status = record_and_recall(argv[1]);
  if (!status.ok()) fmt::print(stderr, "{}\n", status.to_string());
  return status.ok() ? 0 : 1;
}
