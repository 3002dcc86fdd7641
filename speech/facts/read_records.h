// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: values as records.

#include <map>

#include "ltm/idf/data.h"
#include "speech/facts/known_world.h"
#include "speech/facts/records.h"

namespace engram::speech {

/// Executions by the entity of their events and by when they started, so that the events of one
/// meet.
class ExecutionTable {
 public:
  /// Adds what an event tells. `id` is its instance.
  void add(const ltm::MemoryId& id, const idf::Data& value, const KnownWorld& world);

  /// In the order of their starts; valid until the next event is added.
  [[nodiscard]] const std::vector<Execution>& in_order();

 private:
  std::map<std::pair<Time, ltm::MemoryId>, Execution> table_;
  std::vector<Execution> sorted_;
  bool is_sorted_ = true;
};

[[nodiscard]] SpokenWords read_words(const ltm::MemoryId& id, const idf::Data& value);
[[nodiscard]] TaskPlan read_plan(const ltm::MemoryId& id, const idf::Data& value);
[[nodiscard]] RefusedRequest read_refusal(const ltm::MemoryId& id, const idf::Data& value);
[[nodiscard]] DriveNote read_drive_note(const ltm::MemoryId& id, const idf::Data& value);
[[nodiscard]] ThingState read_thing_state(const ltm::MemoryId& id, const idf::Data& value);
[[nodiscard]] KnownPlace read_surface(const ltm::MemoryId& id, const idf::Data& value);
[[nodiscard]] KnownPlace read_location(const ltm::MemoryId& id, const idf::Data& value);

/// The provider of "robot/pick": "robot"; empty where it has none.
[[nodiscard]] std::string provider_of(const std::string& name);
/// "robot/pick" without its provider.
[[nodiscard]] std::string skill_of(const std::string& name);

}  // namespace engram::speech
