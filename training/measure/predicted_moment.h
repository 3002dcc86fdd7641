// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/recall/recall.h"
#include "training/measure/evaluate_report.h"

namespace engram::training {

/// One prediction, and the real snapshot if the store has it. Errors are those of the first
/// instance.
struct PredictedHorizon {
  ltm::SnapshotResult predicted;
  /// The snapshot closest to the predicted time, less than half a step away.
  std::optional<ltm::SnapshotResult> actual;
  std::optional<ltm::MeasuredError> error;       ///< Error of the prediction, if known.
  std::optional<ltm::MeasuredError> copy_error;  ///< Error of a copy of the last snapshot.
  ltm::ErrorEstimate copy_told;                  ///< Estimate that such a copy would have had.

  /// Whether the error is within the predicted bound, in each kind that has one. Empty if error or
  /// bound is not known.
  [[nodiscard]] std::optional<bool> is_within() const;
};

/// The predictions from one moment.
struct PredictedMoment {
  ltm::SnapshotResult last;  ///< The snapshot from which predictions start.
  std::vector<PredictedHorizon> horizons;
};

/// Where predictions, and what came of them, are asked: a Recall, or a memory of any kind.
struct PredictionSource {
  std::function<Result<std::vector<ltm::SnapshotResult>>(const ltm::PredictionRequest&)> predict;
  std::function<Result<ltm::QueryResult>(const ltm::Query&)> query;
};

/// A source that asks `recall`, which must outlive it, about one entity.
[[nodiscard]] PredictionSource source_of(ltm::Recall& recall, const ltm::MemoryId& entity);

/// Time between two snapshots as an engine counts it. For an engine without a fixed step it is the
/// median step of the entity's last snapshots, or zero if there is only one.
/// Errors: the errors of the store.
Result<Duration> step_of(ltm::Recall& recall, const ltm::MemoryId& entity,
                         const ltm::Recall::Engine& engine);

/// The median step of the entity's last snapshots, or zero if there is only one.
/// Errors: the errors of the source.
Result<Duration> step_of(const PredictionSource& source, const ltm::MemoryId& entity);

/// Time of the last snapshot that is followed by another one at least `ahead` later.
/// Errors: kNotFound if there is none; the errors of the source.
Result<Time> last_known_from(const PredictionSource& source, const ltm::MemoryId& entity,
                             Duration ahead);

/// Predicts as if nothing after `request.from` were known, and compares with the snapshots that
/// came: with each the one that is less than half a `step` from the predicted time. Members that
/// count in no error are not compared.
/// Errors: the errors of the source.
Result<PredictedMoment> predict_moment(const PredictionSource& source, const ltm::MemoryId& entity,
                                       const ltm::PredictionRequest& request, Duration step);

/// The moments of a sweep.
struct SweepOptions {
  std::optional<Time> first, last;  ///< Both included; by default the first and the last snapshot.
  size_t every = 1;                 ///< Distance between two moments, in snapshots.
};

/// Predicts from many moments. A moment counts only if it has a snapshot before it, and a horizon
/// only if the store has a snapshot at its time. The result is the quality per horizon, in their
/// order; PredictionQuality::horizon is its number from 1 on.
/// Errors: kInvalidArgument if `every` is 0; kCancelled; the errors of Recall.
Result<std::vector<PredictionQuality>> sweep(ltm::Recall& recall, const ltm::MemoryId& entity,
                                             ltm::Recall::PredictionRequest request,
                                             const SweepOptions& options,
                                             const ProgressSink& progress,
                                             const std::stop_token& stop);

}  // namespace engram::training
