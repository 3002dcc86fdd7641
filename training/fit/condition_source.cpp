// SPDX-License-Identifier: Apache-2.0
#include "training/fit/condition_source.h"

#include "encoders/tensor_plan.h"
#include "ltm/memory/links.h"

namespace engram::training {

namespace {

/// Reads the last recorded value at or before a time, if there is one.
Result<std::optional<idf::Data>> condition_at(ltm::StoreReader& reader,
                                              const ltm::MemoryId& condition, Time time) {
  auto timeline = reader.timeline(condition);
  if (timeline.status().code() == StatusCode::kNotFound) return std::optional<idf::Data>();
  ENGRAM_RETURN_IF_ERROR(timeline.status());
  ENGRAM_ASSIGN_OR_RETURN(const auto known, (*timeline)->at_or_before(time));
  if (!known || !known->recorded) return std::optional<idf::Data>();
  ENGRAM_ASSIGN_OR_RETURN(ltm::Snapshot snapshot, reader.read_recorded(condition, *known));
  if (snapshot.instances.empty()) return std::optional<idf::Data>();
  return std::optional(std::move(snapshot.instances.front().data));
}

Result<std::optional<ltm::MemoryId>> find_condition(ltm::StoreReader& reader,
                                                    const ltm::MemoryId& entity,
                                                    const ltm::SnapshotEntry& snapshot) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Snapshot example, reader.read_recorded(entity, snapshot));
  for (const ltm::Instance& instance : example.instances)
    for (const ltm::Link& link : ltm::find_links(instance.data)) {
      if (!link.id.has_entity()) continue;
      const ltm::MemoryId linked = link.id.entity();
      if (linked == entity) continue;
      ENGRAM_ASSIGN_OR_RETURN(const auto value, condition_at(reader, linked, snapshot.time));
      if (!value) continue;
      const auto plan = encoders::TensorPlan::create(idf::Layout::of(*value));
      if (plan.ok() && plan->number_count() > 0 && plan->images().empty())
        return std::optional(linked);
    }
  return std::optional<ltm::MemoryId>();
}

}  // namespace

Status add_condition(ltm::StoreReader& reader, const ltm::MemoryId& entity,
                     const ltm::SnapshotEntry& snapshot, TrainingSource& source) {
  ENGRAM_ASSIGN_OR_RETURN(const auto condition, find_condition(reader, entity, snapshot));
  if (!condition) return {};
  source.condition_entity = condition->to_string();
  source.read_condition = [&reader, id = *condition, times = source.times](size_t index) {
    return condition_at(reader, id, times[index]);
  };
  return {};
}

Result<std::vector<idf::Data>> conditions_at(ltm::StoreReader& reader,
                                             const std::optional<ltm::MemoryId>& condition,
                                             std::span<const Time> times) {
  std::vector<idf::Data> values;
  if (!condition) return values;
  for (const Time time : times) {
    ENGRAM_ASSIGN_OR_RETURN(auto value, condition_at(reader, *condition, time));
    if (!value) return std::vector<idf::Data>{};
    values.push_back(std::move(*value));
  }
  return values;
}

}  // namespace engram::training
