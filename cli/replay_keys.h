// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "memory/replay/running_replay.h"

namespace engram::cli {

/// What a key of a terminal tells a replay.
enum class ReplayKey { kPauseOrPlay, kBack, kForward, kFaster, kSlower, kEnd };

/// Takes all keys that have come out of `bytes`. The beginning of a sequence stays; other keys are
/// dropped.
[[nodiscard]] std::vector<ReplayKey> take_keys(std::string& bytes);

/// Does what a key says, kEnd aside.
/// Errors: those of Replay::obey.
Status press(ReplayKey key, memory::Replay& replay);

/// Whether keys can control a replay: `file` is a terminal, and this process is in front.
[[nodiscard]] bool has_keys(int file);

/// Lets the keys of a terminal control a replay until one ends it, input ends, or `stop` is
/// requested. The terminal gives each key at once and shows none meanwhile; then it is as before.
/// `tell` is called with what was done. Returns whether a key ended it.
bool control_by_keys(int terminal, memory::Replay& replay, const std::stop_token& stop,
                     const std::function<void(const std::string&)>& tell);

/// "2026-01-01 08:00:02, plays at speed 2".
[[nodiscard]] std::string state_text(const ReplayState& state);

}  // namespace engram::cli
