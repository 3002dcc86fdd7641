// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ltm/idf/data.h"
#include "ltm/memory/memory_id.h"
#include "memory/replay/replay_options.h"

namespace engram {

/// What a replay says of itself. It is the value of the entity SystemState/Replay/engram/clock.
/// That is committed with every change, and once a second while the clock goes.
struct ReplayState {
  std::vector<std::string> stores;  ///< What is replayed.
  Time now{};                       ///< The replayed moment.
  double speed = 1;                 ///< Unit: replayed seconds per second.
  bool is_playing = false;
  std::optional<ReplayLoop> loop{};
  Time first{};  ///< Of the first and the last snapshot that was recorded, by their own times.
  Time last{};
  uint64_t jumps = 0;  ///< How often it was set to another moment, loops included.
  uint64_t told = 0;   ///< Recorded snapshots that the clock passed.
  /// Of these, those that nobody was told of, because they are damaged or were forgotten meanwhile.
  uint64_t unreadable = 0;
  /// Predictions that were given out and compared with what came, those of them that had a bound,
  /// and those that kept it. Unit: instances.
  uint64_t scored = 0;
  uint64_t bounded = 0;
  uint64_t within_bound = 0;
  /// Predictions that nothing came for, or that were too many or too large to wait for.
  uint64_t unscored = 0;

  [[nodiscard]] idf::Data to_data() const;

  /// Reads what to_data wrote; safe on hostile values.
  /// Errors: kInvalidArgument naming the member.
  static Result<ReplayState> from_data(const idf::Data& data);

  friend bool operator==(const ReplayState&, const ReplayState&) = default;
};

/// SystemState/Replay/engram/clock.
[[nodiscard]] const ltm::MemoryId& replay_clock_entity();

}  // namespace engram
