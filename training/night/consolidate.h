// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <stop_token>

#include "ltm/core/progress.h"
#include "ltm/core/status.h"
#include "training/night/consolidate_options.h"
#include "training/night/consolidate_plan.h"
#include "training/night/consolidate_report.h"

namespace engram::training {

/// Told what will be done, before anything is trained.
using PlanSink = std::function<void(const ConsolidatePlan&)>;

/// What consolidate() would do, without doing it. Reads what was recorded, writes nothing.
/// Errors: those of consolidate before it trains.
Result<ConsolidatePlan> plan_consolidation(const std::filesystem::path& store,
                                           const ConsolidateOptions& options,
                                           const std::stop_token& stop);

/// The offline phase: trains a model per entity, encodes the entity's recorded snapshots with it,
/// measures what comes back from the stored bytes, and publishes model and latents together.
///
/// An entity that cannot be a tensor is skipped with its reason. Entities are published one by
/// one; a kill at any moment leaves the store with whole ones, and training goes on from its last
/// checkpoint when the job is run again. Runs beside a live writer.
/// Errors: kInvalidArgument; kNotFound where no entity matches; kCancelled on `stop`; those of the
/// store.
/// Threading: one at a time per process (train_model).
Result<ConsolidateReport> consolidate(const std::filesystem::path& store,
                                      const ConsolidateOptions& options,
                                      const ProgressSink& progress, const std::stop_token& stop,
                                      const PlanSink& plan = {});

}  // namespace engram::training
