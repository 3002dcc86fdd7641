// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "viewer/viewed_memory.h"

namespace engram::viewer {

/// Which numbers of which snapshots are drawn.
struct SeriesRequest {
  ltm::MemoryId entity;
  std::vector<std::string> paths;  ///< Those of ShownMember.
  size_t instance = 0;
  ltm::TimeBins bins;
  Duration budget = std::chrono::milliseconds(250);  ///< How long it reads.
};

/// One number over time, drawn: its extremes and its last value in each bin. NaN: nothing was read
/// there.
struct DrawnSeries {
  std::vector<float> min;
  std::vector<float> max;
  std::vector<float> last;
};

struct SeriesAnswer {
  std::vector<DrawnSeries> series;  ///< One per path.
  uint64_t read = 0;                ///< Snapshots that were read.
  uint64_t total = 0;               ///< Those in the span, if that is known; else `read`.
};

/// Draws numbers from as many snapshots as can be read in time, evenly spread: first 64, then those
/// between them, and so on, so that a short budget gives a coarse picture of the whole span.
///
/// What was read of a store is kept for the next requests, until the store changes: numbers are
/// drawn from memory once all were read. Errors: kNotFound, kDataLoss.
Result<SeriesAnswer> sample_series(ViewedMemory& viewed, const SeriesRequest& request);

/// The order in which `count` things are read: each once, coarse first, ascending within a pass.
/// `visit` returns false to end it.
template <typename Visit>
void visit_coarse_first(size_t count, size_t first_pass, const Visit& visit) {
  size_t stride = 1;
  while (count / stride > first_pass) stride *= 2;
  for (size_t i = 0; i < count; i += stride)
    if (!visit(i)) return;
  for (; stride > 1; stride /= 2)
    for (size_t i = stride / 2; i < count; i += stride)
      if (!visit(i)) return;
}

}  // namespace engram::viewer
