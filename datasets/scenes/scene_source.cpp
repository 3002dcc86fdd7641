// SPDX-License-Identifier: Apache-2.0
#include "datasets/scenes/scene_source.h"

namespace engram::datasets {

Result<std::optional<idf::Data>> recorded_at(ltm::StoreReader& store, const ltm::MemoryId& entity,
                                             Time time) {
  const auto timeline = store.timeline(entity);
  if (timeline.status().code() == StatusCode::kNotFound) return std::optional<idf::Data>();
  ENGRAM_RETURN_IF_ERROR(timeline.status());
  ENGRAM_ASSIGN_OR_RETURN(const auto entry, (*timeline)->at_or_before(time));
  if (!entry || entry->time != time || !entry->recorded) return std::optional<idf::Data>();
  ENGRAM_ASSIGN_OR_RETURN(ltm::Snapshot found, store.read_recorded(entity, *entry));
  if (found.instances.empty()) return std::optional<idf::Data>();
  return std::optional(std::move(found.instances.front().data));
}

}  // namespace engram::datasets
