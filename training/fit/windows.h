// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "training/fit/sequences.h"

namespace engram::training {

/// Indices of snapshots in the middle of a window: one before and one after are of the same
/// sequence.
struct Windows {
  std::vector<int64_t> training;  ///< The next snapshot lies in the first 85 % of the sequence.
  std::vector<int64_t> held_out;  ///< It lies in the last 15 %.
};

/// Shape: `row` indexes the dataset; rows up to `row + horizon` are of the same sequence.
[[nodiscard]] Windows make_windows(std::span<const Sequence> sequences, int horizon);

/// The first row of a sequence that the dynamics are not trained on.
[[nodiscard]] size_t held_out_from(const Sequence& sequence);

}  // namespace engram::training
