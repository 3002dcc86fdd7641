// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "ltm/idf/data.h"
#include "ltm/memory/commit.h"
#include "memory/replay/replay_options.h"

namespace engram {

/// What a replay is told to do. It is a value of the entity SystemState/Replay/engram/control, so
/// that any program that may commit there can control a replay.
struct ReplayCommand {
  enum class Kind : uint8_t {
    kPlay,
    kPause,
    kStep,  ///< Pauses, and goes on to the next commit that was recorded.
    kSeek,
    kSpeed,
    kLoop,
  };

  Kind kind = Kind::kPlay;
  Time time{};                       ///< Where kSeek goes.
  double speed = 1;                  ///< Of kSpeed. Unit: replayed seconds per second.
  std::optional<ReplayLoop> loop{};  ///< Of kLoop; empty: ends the loop.

  /// Errors: kInvalidArgument for a speed that check_replay_speed() refuses, or a loop that ends
  /// before it begins.
  [[nodiscard]] Status validate() const;

  /// Returns {"command": "seek", "time": ns}, {"command": "speed", "speed": 2.0}, {"command":
  /// "loop", "first": ns, "last": ns} or {"command": "pause"}.
  [[nodiscard]] idf::Data to_data() const;

  /// Reads what to_data wrote; times may be texts of parse_time(). Safe on hostile values.
  /// Errors: kInvalidArgument naming what was found and what was needed.
  static Result<ReplayCommand> from_data(const idf::Data& data);

  friend bool operator==(const ReplayCommand&, const ReplayCommand&) = default;
};

/// "play", "pause", "step", "seek", "speed", "loop".
[[nodiscard]] std::string_view to_string(ReplayCommand::Kind kind);

/// SystemState/Replay/engram/control.
[[nodiscard]] const ltm::MemoryId& replay_control_entity();

/// The commit that tells a replay a command.
[[nodiscard]] ltm::Commit commit_of(const ReplayCommand& command);

}  // namespace engram
