// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/store/latent.h"
#include "training/fit/job_pace.h"
#include "training/night/kept_quality.h"

// Private to this room.

namespace engram::training {

/// The end of encoding, and where its results go in the meantime.
struct EncodingLimits {
  /// Encoding stops before this moment, and what was encoded by then is kept: the oldest snapshots.
  std::optional<Time> end;
  /// Expected time of a snapshot; 0 if it is unknown. Unit: s.
  double seconds_per_snapshot = 0;

  /// Publishes what was encoded since the last call. It gets the quality of everything so far.
  using Publish =
      std::function<Status(const std::vector<ltm::LatentSnapshot>&, const KeptQuality&)>;
  /// Called from time to time, so that a job that is killed loses little; empty for never. What is
  /// left at the end goes to the caller.
  Publish publish;
  Duration publish_interval{};
};

/// Measures how long snapshots take to encode, and tells how many fit into the time that is left.
///
/// Threading: one thread.
class EncodingRate {
 public:
  /// Both must outlive this object.
  EncodingRate(const EncodingLimits& limits, const JobPace& pace) : limits_(limits), pace_(pace) {}

  /// Max number of snapshots to encode next: whole chains, or one of at least 8 rows; 0 if nothing
  /// more fits. Before anything was encoded it is not 0 unless the time is over, so that a short
  /// night does something.
  [[nodiscard]] size_t fitting(size_t chain_rows) const;

  /// Counts snapshots that took so many seconds.
  void count(size_t snapshots, double seconds);

  /// Whether the end has passed by so much that work that was begun has to be given up.
  [[nodiscard]] bool is_over() const;

  /// Time for so many snapshots; -1 if it is unknown. Unit: s.
  [[nodiscard]] double seconds_for(size_t snapshots) const;

 private:
  const EncodingLimits& limits_;
  const JobPace& pace_;
  double last_ = 0;  ///< Time of a snapshot when it was measured last. Unit: s.
  size_t snapshots_ = 0;
  double seconds_ = 0;
};

}  // namespace engram::training
