// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <stop_token>
#include <vector>

#include "ltm/idf/data.h"
#include "ltm/core/sequences.h"
#include "training/measure/crossval_report.h"

// Private to this room.

namespace engram::training {

/// Sums over queried snapshots.
struct SimilaritySums {
  uint64_t snapshots = 0;
  uint64_t others = 0;
  double rank = 0;
  uint64_t neighbours = 0, pixel_neighbours = 0;

  void add(const SimilaritySums& more);
  [[nodiscard]] SimilarityQuality quality() const;
};

/// Finds the nearest snapshot to snapshots of one recording, by global code and by pixels, among
/// all others.
///
/// `codes[i]` is the code of the value that read(i) returns. `asking` is the recording whose
/// snapshots are queried; at most 64 evenly spaced ones are. Each value costs about 50 us per
/// query.
/// Errors: the errors of `read`; kCancelled.
Result<SimilaritySums> measure_similarity(std::span<const std::vector<float>> codes,
                                          const Sequence& asking,
                                          const std::function<Result<idf::Data>(size_t)>& read,
                                          const std::stop_token& stop);

}  // namespace engram::training
