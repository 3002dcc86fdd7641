// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "memory/memory.h"
#include "memory/replay/replay_command.h"
#include "memory/replay/replay_state.h"

namespace engram {

/// Tells a replay what to do: Memory::replay, or that of a server, reached by Memory::connect. Once
/// it returns, all that is asked of the replay is of its new moment.
/// Errors: those of Memory::commit; kInvalidArgument for a command that does not validate or goes
/// before the first snapshot; kNotFound for a step behind the last one; kFailedPrecondition if the
/// memory is no replay.
Status control_replay(Memory& memory, const ReplayCommand& command);

/// What a replay says of itself. While its clock goes, that may be a second old.
/// Errors: those of Memory::query; kFailedPrecondition if the memory is no replay.
Result<ReplayState> replay_state(Memory& memory);

}  // namespace engram
