// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/recall/recall.h"
#include "training/measure/evaluate_report.h"

namespace engram::training {

/// One prediction, and what really came where the store knows it. Errors are those of the first
/// instance.
struct PredictedHorizon {
  ltm::SnapshotResult predicted;
  /// The snapshot closest to that time, less than half a step away.
  std::optional<ltm::SnapshotResult> actual;
  std::optional<ltm::MeasuredError> error;       ///< Of the prediction, where that is known.
  std::optional<ltm::MeasuredError> copy_error;  ///< Of a copy of the last snapshot.
  ltm::ErrorEstimate copy_told;                  ///< What such a copy would have told.

  /// Whether the error is within the bound that the prediction told, in each kind that has one.
  /// Nothing where either is not known.
  [[nodiscard]] std::optional<bool> is_within() const;
};

/// What was predicted from one moment.
struct PredictedMoment {
  ltm::SnapshotResult last;  ///< What it started from.
  std::vector<PredictedHorizon> horizons;
};

/// Time between two snapshots as an engine counts it; where any will do, the median of the
/// entity's last ones. Zero where there is only one snapshot.
/// Errors: those of the store.
Result<Duration> step_of(ltm::Recall& recall, const ltm::MemoryId& entity,
                         const ltm::Recall::Engine& engine);

/// The last snapshot after which there is another one so far ahead.
/// Errors: kNotFound where there is none; those of the store.
Result<Time> last_known_from(ltm::Recall& recall, const ltm::MemoryId& entity, Duration ahead);

/// Predicts as if nothing after `request.from` were known, and compares.
/// Errors: those of Recall.
Result<PredictedMoment> predict_moment(ltm::Recall& recall, const ltm::MemoryId& entity,
                                       const ltm::Recall::PredictionRequest& request);

/// The moments of a sweep.
struct SweepOptions {
  std::optional<Time> first, last;  ///< Both included; nothing: from the first, to the last one.
  size_t every = 1;                 ///< Snapshots.
};

/// Predicts from many moments. Only those count that have a snapshot before them, and only
/// horizons whose time is known. Quality per horizon, in their order; `horizon` is its number.
/// Errors: kInvalidArgument where `every` is 0; kCancelled; those of Recall.
Result<std::vector<PredictionQuality>> sweep(ltm::Recall& recall, const ltm::MemoryId& entity,
                                             ltm::Recall::PredictionRequest request,
                                             const SweepOptions& options,
                                             const ProgressSink& progress,
                                             const std::stop_token& stop);

}  // namespace engram::training
