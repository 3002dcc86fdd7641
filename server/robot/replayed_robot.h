// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "memory/replay/running_replay.h"
#include "server/robot/robot_config.h"

namespace engram::server {

/// Changes the configuration of a robot to one of its replay: Robot::start then starts the same
/// servers, each with what its store held at the replayed moment in place of the store. Nothing is
/// recorded, no prior knowledge is committed, and the state of this machine is not noted: what was
/// noted of the robot's is replayed. The server of the memory SystemState tells of the replay and
/// takes commands; if it has no store the first server that has one gets that memory. A name system
/// elsewhere is left out: it would send the robot's own programs to the replay.
/// Errors: those of memory::Replay::open; kInvalidArgument if no server has a store, or if one
/// without a store has SystemState alone.
/// Source: docs/replay.md.
Result<std::shared_ptr<memory::Replay>> replay_robot(RobotConfig& config, ltm::ModelLoader loader,
                                                     const ReplayOptions& options);

}  // namespace engram::server
