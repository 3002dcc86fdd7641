// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "ltm/core/time.h"

namespace engram::training {

/// Consecutive snapshots of one recording: indices [first, end).
struct Sequence {
  size_t first = 0;
  size_t end = 0;

  [[nodiscard]] size_t size() const { return end - first; }
  friend bool operator==(const Sequence&, const Sequence&) = default;
};

/// The median time between two snapshots; zero for fewer than two.
/// Time: increasing within a recording.
[[nodiscard]] Duration median_step(std::span<const Time> times);

/// Cuts the times of an entity into recordings, where a gap is longer than 1.5 median steps, or
/// where time goes back.
/// Time: increasing within a recording.
[[nodiscard]] std::vector<Sequence> cut_sequences(std::span<const Time> times);

/// The snapshots of one recording as slower ones that lie between each other: in each, snapshots
/// are `every` apart, as far as there are any. The first one starts at the recording's start.
/// Shape: indices into `times`, every one at most once.
[[nodiscard]] std::vector<std::vector<size_t>> interleaved(std::span<const Time> times,
                                                           const Sequence& recording,
                                                           Duration every);

}  // namespace engram::training
