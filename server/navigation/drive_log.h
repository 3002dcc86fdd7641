// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "memory/memory.h"
#include "server/navigation/navigation_types.h"
#include "server/navigation/path_planner.h"

namespace engram::navigation {

/// Who asked for a drive, and where to.
struct DriveRequest {
  /// A location, an alias, an object or piece of furniture; empty: `pose`.
  std::string goal;
  /// Where to in the frame of the world; only looked at where `goal` is empty. A request that has
  /// neither names no place, and is refused.
  std::optional<PlanarPose> pose{};
  ltm::MemoryId request{};  ///< The request of the skill; empty: nobody asked in the memory.
  ltm::MemoryId cause{};    ///< What that was asked for: words, or the plan of a task.
};

/// The goal in words: its name, its place, or that there is none.
[[nodiscard]] std::string goal_text(const DriveRequest& request);

/// Commits the plans and events of a robot's drives, each with its links.
///
/// Plans are Navigation/Plan/ROBOT/drive, events are Navigation/Event/ROBOT/drive.
/// Threading: one thread.
/// Owns: nothing of the memory, which must outlive it.
class DriveLog {
 public:
  /// Errors: kInvalidArgument where the robot's name is none; those of Memory::declare.
  static Result<DriveLog> open(Memory& memory, const std::string& robot);

  /// What a plan was made of.
  struct PlanInputs {
    const CostMap& map;
    PlanarPose start;
    PlanarPose goal;
    ltm::MemoryId location;
    uint32_t seed = 0;
  };

  /// Returns the link to the plan.
  Result<ltm::MemoryId> commit_plan(const DriveRequest& request, const FoundPath& found,
                                    const PlanInputs& inputs, Time time);

  struct EventInputs {
    ::navigation::EventKind kind{};
    std::string reason;
    ltm::MemoryId plan;
    ltm::MemoryId cost_map;
    std::vector<Obstacle> blocked_by{};
    PlanarPose robot;
  };

  /// Returns the link to the event. Events that end a drive wait until they survive a crash.
  Result<ltm::MemoryId> commit_event(const DriveRequest& request, const EventInputs& inputs,
                                     Time time);

 private:
  DriveLog(Memory& memory, std::string robot, ltm::MemoryId plans, ltm::MemoryId events)
      : memory_(&memory),
        robot_(std::move(robot)),
        plans_(std::move(plans)),
        events_(std::move(events)) {}

  Result<ltm::MemoryId> commit(const ltm::MemoryId& entity, idf::Data value, Time time,
                               CommitDurability durability);

  Memory* memory_;
  std::string robot_;
  ltm::MemoryId plans_;
  ltm::MemoryId events_;
  Time last_{};
};

/// Whether a drive ends with this event.
[[nodiscard]] bool is_end(::navigation::EventKind kind);

}  // namespace engram::navigation
