// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ltm/core/time.h"

namespace engram {

/// A part of the past that a replay repeats, both ends included.
struct ReplayLoop {
  Time first{};
  Time last{};

  /// Errors: kInvalidArgument unless it ends after it begins.
  [[nodiscard]] Status validate() const;

  friend bool operator==(const ReplayLoop&, const ReplayLoop&) = default;
};

/// The bounds of its speed. Unit: replayed seconds per second.
inline constexpr double kMinReplaySpeed = 0.001;
inline constexpr double kMaxReplaySpeed = 1000;

/// How a replay begins.
struct ReplayOptions {
  /// The moment to begin with. Empty: that of the first snapshot.
  std::optional<Time> at{};
  double speed = 1;  ///< From 0.001 to 1000. Unit: replayed seconds per second.
  /// Whether the clock stands still at first, so that programs can subscribe before anything comes.
  bool is_paused = false;
  /// One that ends before the moment to begin with is entered at its beginning.
  std::optional<ReplayLoop> loop{};

  /// Errors: kInvalidArgument.
  [[nodiscard]] Status validate() const;
};

/// Errors: kInvalidArgument for a speed that is not from 0.001 to 1000.
Status check_replay_speed(double speed);

}  // namespace engram
