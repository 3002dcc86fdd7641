// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/core/sequences.h"

namespace engram::training {

/// Consecutive snapshots that are read for training. Those from `first_held_out` on are of the
/// held-out end of their recording.
struct SnapshotRun {
  Sequence rows;
  size_t first_held_out = 0;

  friend bool operator==(const SnapshotRun&, const SnapshotRun&) = default;
};

/// What is read of recordings, in their order.
struct ThinnedRuns {
  std::vector<SnapshotRun> read;
  std::vector<Sequence> left_out;  ///< Of what is trained on.
};

/// Chooses what is read of recordings: all if they have at most `max_rows` snapshots. Otherwise
/// runs of at most 32 snapshots, evenly spaced over all recordings, and at least one run each of
/// what is trained on and of what is held out. What is held out stays the end of a recording, so
/// that it is as far from training as without thinning.
[[nodiscard]] ThinnedRuns thinned(const std::vector<Sequence>& recordings, size_t max_rows);

}  // namespace engram::training
