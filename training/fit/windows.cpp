// SPDX-License-Identifier: Apache-2.0
#include "training/fit/windows.h"

#include <algorithm>
#include <cmath>

namespace engram::training {

namespace {

constexpr double kHeldOutShare = 0.15;

}  // namespace

size_t held_out_from(const Sequence& recording) {
  const auto held_out =
      static_cast<size_t>(std::ceil(kHeldOutShare * static_cast<double>(recording.size())));
  return recording.end - std::min(held_out, recording.size());
}

Windows make_windows(std::span<const Sequence> sequences, std::span<const size_t> first_held_out,
                     int horizon) {
  Windows windows;
  const auto ahead = static_cast<size_t>(horizon);
  for (size_t i = 0; i < sequences.size(); ++i) {
    const Sequence& sequence = sequences[i];
    const size_t limit = first_held_out[i];
    for (size_t row = sequence.first + 1; row + ahead < sequence.end; ++row) {
      if (row + ahead < limit)
        windows.training.push_back(static_cast<int64_t>(row));
      else
        windows.held_out.push_back(static_cast<int64_t>(row));
    }
  }
  return windows;
}

}  // namespace engram::training
