// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "ltm/core/mutex.h"
#include "memory/memory.h"
#include "server/behavior_tree/behavior_tree_library.h"
#include "server/skills/skill_call.h"

namespace engram::behavior_tree {

/// What all nodes of a tree have in common.
struct SkillNodeOptions {
  std::string requester = "behavior_tree";  ///< Who asks: a name of a provider segment.
  std::vector<ltm::MemoryId> causes{};      ///< Why the tree runs.
  /// How long nothing may be heard before a request has failed: there is no skill memory.
  Duration answer_within = std::chrono::seconds(10);
};

/// The skill that a node executes, with the parameters that are ports of it.
struct NodeSkill {
  std::string name;  ///< "PROVIDER/SKILL".
  std::vector<::skill::Parameter> parameters{};
};

/// A leaf that asks the skill memory for one execution: RUNNING until it has ended, then SUCCESS,
/// or FAILURE for each other end (refused, failed, stopped, lost).
///
/// Ports in: the parameters of the skill, or `skill` and `parameters` ("times=2; text=Hello.", or a
/// blackboard entry with JSON) if it executes any;
/// `skill_wait` ("5s"), how long the request may wait for conditions and resources; `skill_causes`,
/// IDs separated by semicolons. Ports out: `skill_reason`, `skill_result` (JSON), `skill_end`, the
/// ID of the event or refusal that says so. A parameter whose port is not set has its default.
///
/// A node that is halted stops the execution, and waits until it has ended: what comes next in the
/// tree finds the robot at rest, and its resources free.
/// Errors: a port that is missing or cannot be read is a BT::RuntimeError that names it.
/// Threading: as all nodes, by the thread that ticks. Owns: nothing of the memory, which must
/// outlive it. Source: docs/skills.md, "Behavior trees".
class SkillNode final : public BT::StatefulActionNode {
 public:
  /// Without a `skill` it executes the one that its port names.
  SkillNode(const std::string& name, const BT::NodeConfiguration& config, Memory& memory,
            std::optional<NodeSkill> skill, SkillNodeOptions options);
  ~SkillNode() override;

  /// The ports of a node for `skill`.
  static BT::PortsList ports_of(const std::optional<NodeSkill>& skill);
  /// The port of a parameter: its name, or NAME_ where the library or a SkillNode keeps that one.
  static std::string port_of(const std::string& parameter);

  BT::NodeStatus onStart() override;
  BT::NodeStatus onRunning() override;
  void onHalted() override;

 private:
  [[nodiscard]] skills::SkillRequest request();
  [[nodiscard]] std::optional<std::string> input(const std::string& port);
  [[nodiscard]] std::string parameters_json();
  void tell(const std::string& port, const std::string& text);
  BT::NodeStatus end(const Result<skills::SkillResult>& result);

  Memory& memory_;
  const std::optional<NodeSkill> skill_;
  const SkillNodeOptions options_;
  Mutex mutex_;
  std::optional<Result<skills::SkillResult>> result_ ENGRAM_GUARDED_BY(mutex_);
  std::jthread running_;
};

}  // namespace engram::behavior_tree
