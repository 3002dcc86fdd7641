// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "training/fit/sequences.h"

namespace engram::training {

/// Indices of snapshots in the middle of a window: the snapshots before and after are of the same
/// sequence.
struct Windows {
  std::vector<int64_t> training;  ///< The next snapshot is in the first 85 % of the sequence.
  std::vector<int64_t> held_out;  ///< It is in the last 15 %.
};

/// Makes the windows of some sequences. Indices are rows of the dataset, and the rows up to
/// `horizon` after each are of the same sequence.
[[nodiscard]] Windows make_windows(std::span<const Sequence> sequences, int horizon);

/// The first row of a sequence that the dynamics are not trained on.
[[nodiscard]] size_t held_out_from(const Sequence& sequence);

}  // namespace engram::training
