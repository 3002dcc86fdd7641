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
/// Time: strictly increasing.
[[nodiscard]] Duration median_step(std::span<const Time> times);

/// Cuts the times of an entity into recordings, where a gap is longer than 1.5 median steps.
/// Time: strictly increasing.
[[nodiscard]] std::vector<Sequence> cut_sequences(std::span<const Time> times);

}  // namespace engram::training
