// SPDX-License-Identifier: Apache-2.0
#include "memory/replay/replay_options.h"

namespace engram {

Status check_replay_speed(double speed) {
  if (speed >= kMinReplaySpeed && speed <= kMaxReplaySpeed) return {};
  return invalid_argument("replay: found a speed of {}, needs one from {} to {}", speed,
                          kMinReplaySpeed, kMaxReplaySpeed);
}

Status ReplayLoop::validate() const {
  if (last > first) return {};
  return invalid_argument("replay: found a loop from {} to {}, needs one that ends later",
                          to_string(first), to_string(last));
}

Status ReplayOptions::validate() const {
  ENGRAM_RETURN_IF_ERROR(check_replay_speed(speed));
  return loop ? loop->validate() : Status();
}

}  // namespace engram
