// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what a robot did, and how it ended.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ltm/idf/type.h"
#include "ltm/memory/action_outcome.h"
#include "ltm/reflection/finding_list.h"
#include "ltm/reflection/reflection.h"

namespace engram::ltm {

/// Collects actions: values with the members `skill` and `outcome`, and `started` and `ended` where
/// they have them. The object is the first link whose member begins with `object`; the hand is the
/// member `hand`, the place one of `surface`, `place`, `location`, `target`; of events of skills
/// also such parameters.
///
/// An outcome is an enum whose names, or a text that, tells of success, failure, a stop or running;
/// or a bool.
///
/// Threading: one thread.
class ActionLog {
 public:
  /// Max number of snapshots of actions that are kept.
  static constexpr size_t kMaxActions = 1'000'000;

  /// Adds a snapshot if its value is an action's. Returns whether it is.
  bool add(const MemoryId& entity, Time time, const idf::Data& value,
           const std::optional<idf::Type>& type);

  /// Rates of success, chains of failures, and actions without end or begin. `end` is the last
  /// moment that the store knows.
  void reflect(Time end, Reflection& reflection,
               const std::map<MemoryId, EntityReflection*>& entities, FindingList& findings) const;

 private:
  /// A snapshot of an action.
  struct Row {
    MemoryId entity;
    Time time{};
    std::string skill;
    ActionOutcome outcome = ActionOutcome::kUnknown;
    Time started{};
    bool has_started = false;
    std::string object, hand, place;
  };

  /// An action: its first snapshot, and its last one where it ended.
  struct Action {
    const Row* row = nullptr;
    bool has_begun = false;
    ActionOutcome outcome = ActionOutcome::kRunning;
    Time started{};
    std::optional<Time> ended;
  };

  /// What members of these names say of object, hand and place, where nothing did before.
  static void take_names(const idf::Dict& dict, Row& row);
  [[nodiscard]] std::vector<Action> actions() const;
  static void find_broken(const std::vector<Action>& actions, Time end, Reflection& reflection,
                          const std::map<MemoryId, EntityReflection*>& entities,
                          FindingList& findings);
  static void rate_skills(const std::vector<Action>& actions, Reflection& reflection);
  static void find_chains(const std::vector<Action>& actions, Reflection& reflection);

  std::vector<Row> rows_;
};

}  // namespace engram::ltm
