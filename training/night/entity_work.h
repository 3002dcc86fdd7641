// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "ltm/core/status.h"
#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"
#include "ltm/store/store_reader.h"
#include "training/fit/job_pace.h"
#include "training/night/consolidate_options.h"
#include "training/night/entity_costs.h"

// Private to this room.

namespace engram::training {

/// The input that every step of the work on one entity gets besides the results of earlier steps.
///
/// It owns only the name. The job owns the rest, which outlives all steps.
struct EntityWork {
  ltm::StoreReader& reader;  ///< One generation of the store.
  ltm::MemoryId entity;
  const ConsolidateOptions& options;
  JobPace& pace;
  EntityCosts& costs;

  /// Counts the time until its end for a stage.
  [[nodiscard]] StageTimes::Scope stage(Stage now) const { return {&costs.stages, now}; }
};

/// The time for one entity.
struct Allotment {
  Duration budget{};        ///< Time for training.
  std::optional<Time> end;  ///< If set, training ends at this moment instead.
  /// Set with `end`: encoding ends before this moment, and what is left waits for a later night.
  std::optional<Time> encoded_end;
  double seconds_per_snapshot = 0;  ///< Expected time of encoding; 0 if unknown. Unit: s.
};

/// The reason why an entity stays unchanged while the job continues with the next one.
struct Skipped {
  std::string reason;
  /// Whether the time was over. Then the next job continues from the checkpoint.
  bool is_late = false;
};

/// Returns the reason to skip an entity if `error`, from fitting or encoding, concerns this entity
/// alone: the time is over, or its values cannot be tensors, or no codec accepts its images. The
/// result is empty if the error ends the whole job. `error` must be an error (checked).
[[nodiscard]] std::optional<Skipped> skipped_by(const Status& error, const JobPace& pace);

/// The result of a step that may find that the entity stays unchanged.
template <typename T>
using OrSkipped = std::variant<T, Skipped>;

/// Returns a value or the reason to skip the entity. Errors: those that end the whole job.
template <typename T>
Result<OrSkipped<T>> or_skipped(Result<T> result, const JobPace& pace) {
  if (result.ok()) return OrSkipped<T>(*std::move(result));
  if (auto skipped = skipped_by(result.status(), pace)) return OrSkipped<T>(*std::move(skipped));
  return result.status();
}

/// Returns the reason if the time was over before anything was encoded.
[[nodiscard]] Skipped nothing_encoded();

}  // namespace engram::training
