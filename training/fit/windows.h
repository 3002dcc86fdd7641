// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "ltm/core/sequences.h"

namespace engram::training {

/// Indices of snapshots in the middle of a window: the snapshots before and after are of the same
/// sequence.
struct Windows {
  std::vector<int64_t> training;  ///< What follows is not held out.
  std::vector<int64_t> held_out;  ///< The last of what follows is held out.
};

/// Makes the windows of some sequences. Indices are rows of the dataset, and the rows up to
/// `horizon` after each are of the same sequence. `first_held_out`: per sequence, the first row
/// that is held out.
[[nodiscard]] Windows make_windows(std::span<const Sequence> sequences,
                                   std::span<const size_t> first_held_out, int horizon);

/// The first snapshot of a recording that the dynamics are not trained on: the last 15 % are held
/// out.
[[nodiscard]] size_t held_out_from(const Sequence& recording);

}  // namespace engram::training
