// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/drive_log.h"

#include <algorithm>

namespace engram::navigation {

namespace {

idf::NdArray array_of_path(const std::vector<PlanarPose>& path) {
  std::vector<double> numbers;
  numbers.reserve(3 * path.size());
  for (const PlanarPose& pose : path)
    numbers.insert(numbers.end(), {pose.x_m, pose.y_m, pose.heading_rad});
  return idf::NdArray::take<double>({static_cast<int64_t>(path.size()), 3}, std::move(numbers));
}

std::vector<ltm::MemoryId> snapshots_of(const std::vector<Obstacle>& obstacles) {
  std::vector<ltm::MemoryId> snapshots;
  for (const Obstacle& obstacle : obstacles) snapshots.push_back(obstacle.snapshot);
  return snapshots;
}

}  // namespace

std::string goal_text(const DriveRequest& request) {
  if (!request.goal.empty()) return request.goal;
  if (!request.pose) return "no place";
  return fmt::format("({:.2f}, {:.2f}, {:.2f} rad)", request.pose->x_m, request.pose->y_m,
                     request.pose->heading_rad);
}

bool is_end(::navigation::EventKind kind) {
  using enum ::navigation::EventKind;
  return kind != STARTED && kind != REPLANNED && kind != BLOCKED;
}

Result<DriveLog> DriveLog::open(Memory& memory, const std::string& robot) {
  ENGRAM_ASSIGN_OR_RETURN(ltm::MemoryId plans,
                          ltm::MemoryId::from_names({"Navigation", "Plan", robot, "drive"}));
  ENGRAM_ASSIGN_OR_RETURN(ltm::MemoryId events,
                          ltm::MemoryId::from_names({"Navigation", "Event", robot, "drive"}));
  ENGRAM_RETURN_IF_ERROR(memory.declare(plans.parent().parent(), ::navigation::Plan::idf_type()));
  ENGRAM_RETURN_IF_ERROR(memory.declare(events.parent().parent(), ::navigation::Event::idf_type()));
  return DriveLog(memory, robot, std::move(plans), std::move(events));
}

Result<ltm::MemoryId> DriveLog::commit_plan(const DriveRequest& request, const FoundPath& found,
                                            const PlanInputs& inputs, Time time) {
  ::navigation::Plan plan;
  plan.robot = robot_;
  plan.state =
      found.is_found() ? ::navigation::PlanState::PLANNED : ::navigation::PlanState::REFUSED;
  plan.reason = found.reason;
  plan.request = request.request;
  plan.cause = request.cause;
  plan.goal = goal_text(request);
  plan.location = inputs.location;
  plan.pose_world_start = inputs.start.to_array();
  plan.pose_world_goal = inputs.goal.to_array();
  plan.cost_map = inputs.map.id;
  plan.objects = snapshots_of(inputs.map.obstacles);
  plan.blocked_by = snapshots_of(found.blocked_by);
  plan.path = array_of_path(found.path);
  plan.length = found.length_m;
  plan.planner = "RRTConnect";
  plan.seed = inputs.seed;
  return commit(plans_, plan.to_idf(), time, CommitDurability::kMemory);
}

Result<ltm::MemoryId> DriveLog::commit_event(const DriveRequest& request, const EventInputs& inputs,
                                             Time time) {
  ::navigation::Event event;
  event.kind = inputs.kind;
  event.robot = robot_;
  event.reason = inputs.reason;
  event.goal = goal_text(request);
  event.plan = inputs.plan;
  event.request = request.request;
  event.cause = request.cause;
  event.cost_map = inputs.cost_map;
  event.blocked_by = snapshots_of(inputs.blocked_by);
  event.pose_world_robot = inputs.robot.to_array();
  // A moving robot does not wait for a disk. What ends a drive does, and with it all before it.
  return commit(events_, event.to_idf(), time,
                is_end(inputs.kind) ? CommitDurability::kDefault : CommitDurability::kMemory);
}

Result<ltm::MemoryId> DriveLog::commit(const ltm::MemoryId& entity, idf::Data value, Time time,
                                       CommitDurability durability) {
  // Plans and events of one moment keep their order.
  last_ = std::max(time, last_ + Duration(1));
  ltm::Instance instance{std::move(value), {}};
  instance.metadata.created = last_;
  instance.metadata.provider = robot_;
  ENGRAM_RETURN_IF_ERROR(memory_->commit({{{entity, last_, {std::move(instance)}}}}, durability));
  return entity.at(last_).instance(0);
}

}  // namespace engram::navigation
