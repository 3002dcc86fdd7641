// SPDX-License-Identifier: Apache-2.0
#include "datasets/plain_files.h"

namespace engram::datasets {

Status PlainFiles::commit(const ltm::Commit& commit) {
  for (const ltm::EntityUpdate& update : commit.updates) {
    std::unique_ptr<SnapshotSink>& sink = sinks_[update.entity];
    if (!sink) {
      ENGRAM_ASSIGN_OR_RETURN(sink, make_snapshot_sink("armarx", directory_, {}));
      ENGRAM_RETURN_IF_ERROR(sink->begin(update.entity));
    }
    ltm::SnapshotResult snapshot;
    snapshot.time = update.time;
    for (const ltm::Instance& instance : update.instances)
      snapshot.append(instance.data, instance.metadata);
    ENGRAM_RETURN_IF_ERROR(sink->add(snapshot));
  }
  return {};
}

Status PlainFiles::finish() {
  for (const auto& [entity, sink] : sinks_) ENGRAM_RETURN_IF_ERROR(sink->finish());
  return {};
}

}  // namespace engram::datasets
