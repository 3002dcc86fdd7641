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

/// The median time between two snapshots; zero for fewer than two. Times must increase within a
/// recording.
[[nodiscard]] Duration median_step(std::span<const Time> times);

/// Cuts the times of an entity into recordings: at gaps longer than 1.5 median steps, and where
/// time decreases. Times must increase within a recording.
[[nodiscard]] std::vector<Sequence> cut_sequences(std::span<const Time> times);

/// Splits one recording into interleaved slower ones, in which snapshots are `every` apart. The
/// first one starts at the start of the recording.
/// Shape: indices into `times`, each at most once.
[[nodiscard]] std::vector<std::vector<size_t>> interleaved(std::span<const Time> times,
                                                           const Sequence& recording,
                                                           Duration every);

}  // namespace engram::training
