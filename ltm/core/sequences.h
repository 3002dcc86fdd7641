// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "ltm/core/time.h"

namespace engram {

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

/// Cuts the times of an entity into what is coded together: at gaps that are unusual for its
/// filter, which are those of more than four times the step that nine in ten are no longer than,
/// rounded up to a power of two of milliseconds. Times must not decrease.
///
/// A filter that keeps what changes leaves uneven steps. They matter to networks that predict the
/// next step, for which cut_sequences() is, and not to videos and latents: a longer chain takes
/// fewer bytes whatever the time between its images. The limit is rounded because what was coded
/// before is found again only if it is cut as before, and each night brings new steps.
[[nodiscard]] std::vector<Sequence> cut_recordings(std::span<const Time> times);

/// Splits one recording into interleaved slower ones, in which snapshots are `every` apart. The
/// first one starts at the start of the recording.
/// Shape: indices into `times`, each at most once.
[[nodiscard]] std::vector<std::vector<size_t>> interleaved(std::span<const Time> times,
                                                           const Sequence& recording,
                                                           Duration every);

}  // namespace engram
